// OpenCASCADE's Defeaturing removes faces and extends their neighbours, as for fillets that are to
// go; round an edge of the part the neighbours are the two offset faces, so that what it gives is
// their mitre. It fails on some groups, and fills holes or swallows walls on others without a word:
// phi and the volume tell, since a mitre fills up no more than what lies between the arcs and their
// corners, and no point of it is nearer than |d| or farther than the limit. All groups are tried at
// once, which is mostly right and fast, else by halves; a single one that fails by cells.
#include "rebuild/mitre_join.h"

#include <BRepAdaptor_Curve.hxx>
#include <BRepAlgoAPI_Defeaturing.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <BRep_Tool.hxx>
#include <TopExp.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "exchange/guard.h"
#include "exchange/measures.h"
#include "exchange/shape_bytes.h"
#include "patches/patch_tools.h"
#include "rebuild/mitre_cells.h"
#include "rebuild/origin.h"
#include "rebuild/reunite.h"
#include "rebuild/select.h"

namespace phront::cad {
namespace {

constexpr double kMemoryMiB = 3000;
constexpr double kTryShare = 0.4;  // of the time left
constexpr double kLeastSeconds = 0.5;
constexpr int kEdgeSamples = 5;
/// Of the area of the arcs times the height of the corners above them; the corners taper off, but
/// may also close what lies between arcs.
constexpr double kFill = 1.5;
constexpr double kExtension = 1.5;  // of the farthest corner: faces must cross, not just meet

using Origins = std::set<Feature>;

/// Faces that hang together, and what of the part they stem from.
struct Group {
  Origins origins;
  std::vector<TopoDS_Shape> faces;
};

class MitreMaker {
 public:
  MitreMaker(const MitreRequest& request, const TrueDistance& phi, const Deadline& deadline)
      : request_(request),
        phi_(phi),
        deadline_(deadline),
        widestAngle_(2 * std::acos(std::min(1.0, 1 / request.limit))) {}

  MitreJoin make(const TopoDS_Shape& solid) {
    MitreJoin join{solid, 0, 0};
    // Groups are found again by their origins: faces change their identity on every way home.
    std::vector<Origins> all;
    for (const Group& group : groupsOf(solid, &join.rounded)) all.push_back(group.origins);
    std::vector<std::vector<Origins>> todo;
    if (!all.empty()) todo.push_back(std::move(all));
    while (!todo.empty() && deadline_.left() > kLeastSeconds) {
      const std::vector<Origins> next = std::move(todo.back());
      todo.pop_back();
      if (tryWithout(next, join) || next.size() == 1) continue;
      const auto middle = next.begin() + static_cast<std::ptrdiff_t>(next.size() / 2);
      todo.emplace_back(middle, next.end());
      todo.emplace_back(next.begin(), middle);
    }
    return join;
  }

 private:
  [[nodiscard]] bool mayGo(const Feature& origin) const {
    if (origin.kind == FeatureKind::Face || origin.id == kNone) return false;
    if (origin.kind == FeatureKind::Vertex) return true;
    const auto& edges = phi_.tessellation().features.edges;
    return edges[static_cast<std::size_t>(origin.id)].maxDihedral <= widestAngle_;
  }

  /// `roundFaces`, if given: how many faces stem from edges and vertices.
  std::vector<Group> groupsOf(const TopoDS_Shape& solid, int* roundFaces) const {
    TopTools_IndexedMapOfShape faces;
    TopExp::MapShapes(solid, TopAbs_FACE, faces);
    std::map<int, Feature> removable;
    for (int f = 1; f <= faces.Extent(); ++f) {
      const Feature origin = originOf(TopoDS::Face(faces(f)), phi_);
      if (origin.kind == FeatureKind::Face) continue;
      if (roundFaces != nullptr) ++*roundFaces;
      if (mayGo(origin)) removable[f] = origin;
    }
    TopTools_IndexedMapOfShape edges;
    std::vector<std::vector<int>> facesAt;
    for (const auto& [f, origin] : removable) {
      for (const TopoDS_Edge& edge : edgesOf(TopoDS::Face(faces(f)))) {
        const auto e = static_cast<std::size_t>(edges.Add(edge));
        if (facesAt.size() < e) facesAt.emplace_back();
        facesAt[e - 1].push_back(f);
      }
    }
    std::map<int, int> groupOf;
    for (const auto& [f, origin] : removable) groupOf[f] = f;
    const auto root = [&](int f) {
      while (groupOf[f] != f) f = groupOf[f];
      return f;
    };
    for (const std::vector<int>& users : facesAt)
      for (const int f : users)
        groupOf[std::max(root(f), root(users[0]))] = std::min(root(f), root(users[0]));
    std::map<int, Group> groups;
    for (const auto& [f, origin] : removable) {
      Group& group = groups[root(f)];
      group.origins.insert(origin);
      group.faces.push_back(faces(f));
    }
    std::vector<Group> all;
    for (auto& [first, group] : groups) all.push_back(std::move(group));
    return all;
  }

  /// The groups with these origins, as they are in `solid`.
  std::vector<Group> groupsWith(const std::vector<Origins>& wanted,
                                const TopoDS_Shape& solid) const {
    std::vector<Group> groups = groupsOf(solid, nullptr);
    groups.erase(std::remove_if(groups.begin(), groups.end(),
                                [&](const Group& group) {
                                  return std::find(wanted.begin(), wanted.end(), group.origins) ==
                                         wanted.end();
                                }),
                 groups.end());
    return groups;
  }

  /// Takes `join.solid` without the groups' faces if that is a mitre. Cells are for one group: they
  /// are dear and leave faces divided, but know inside from outside.
  bool tryWithout(const std::vector<Origins>& wanted, MitreJoin& join) const {
    const std::vector<Group> groups = groupsWith(wanted, join.solid);
    if (groups.empty()) return true;
    TopoDS_Shape sharp = mitreBy([&] { return without(join.solid, groups); }, groups, join.solid);
    if (sharp.IsNull() && groups.size() == 1) {
      sharp = mitreBy([&] { return ofCells(join.solid, groups.front()); }, groups, join.solid);
      if (!sharp.IsNull()) {
        const TopoDS_Shape whole = reuniteFaces(sharp, phi_, secondsForTry());
        if (!whole.IsNull() && BRepCheck_Analyzer(whole).IsValid()) sharp = onlySolid(whole);
      }
    }
    if (sharp.IsNull()) return false;
    join.solid = sharp;
    int gone = 0;
    for (const Group& group : groups) gone += static_cast<int>(group.faces.size());
    join.sharpened += gone;
    join.rounded -= gone;
    return true;
  }

  [[nodiscard]] double secondsForTry() const {
    return std::max(kLeastSeconds, kTryShare * deadline_.left());
  }

  /// What `make` makes of `arcs` in a child, if it is a mitre; else null.
  [[nodiscard]] TopoDS_Shape mitreBy(const std::function<TopoDS_Shape()>& make,
                                     const std::vector<Group>& groups,
                                     const TopoDS_Shape& arcs) const {
    const Result<std::string> bytes = runInChild(
        "extending faces to a mitre", {secondsForTry(), kMemoryMiB}, [&]() -> Result<std::string> {
          const TopoDS_Shape sharp = make();
          const bool mitre = !sharp.IsNull() && growsLittle(arcs, groups, sharp) && isMitre(sharp);
          return mitre ? bytesOfShape(sharp) : std::string();
        });
    if (!bytes || bytes->empty()) return {};
    const Result<TopoDS_Shape> sharp = shapeOfBytes(*bytes);
    return sharp ? *sharp : TopoDS_Shape();
  }

  [[nodiscard]] TopoDS_Shape ofCells(const TopoDS_Shape& arcs, const Group& group) const {
    const double extension = kExtension * request_.limit * std::abs(request_.distance);
    return onlySolid(mitreOfCells(arcs, group.faces, extension, request_.distance, phi_));
  }

  // Null unless all faces are gone and one solid is left.
  static TopoDS_Shape without(const TopoDS_Shape& solid, const std::vector<Group>& groups) {
    BRepAlgoAPI_Defeaturing defeaturing;
    defeaturing.SetShape(solid);
    for (const Group& group : groups)
      for (const TopoDS_Shape& face : group.faces) defeaturing.AddFaceToRemove(face);
    defeaturing.Build();
    if (!defeaturing.IsDone() || defeaturing.HasErrors() || defeaturing.HasWarnings()) return {};
    return onlySolid(defeaturing.Shape());
  }

  static TopoDS_Shape onlySolid(const TopoDS_Shape& shape) {
    TopTools_IndexedMapOfShape solids;
    if (!shape.IsNull()) TopExp::MapShapes(shape, TopAbs_SOLID, solids);
    return solids.Extent() == 1 ? solids(1) : TopoDS_Shape();
  }

  /// A mitre fills up what is between the arcs and its corners.
  [[nodiscard]] bool growsLittle(const TopoDS_Shape& arcs, const std::vector<Group>& groups,
                                 const TopoDS_Shape& sharp) const {
    double area = 0;
    for (const Group& group : groups)
      for (const TopoDS_Shape& face : group.faces) area += areaOf(face);
    const double distance = std::abs(request_.distance);
    const double most = kFill * area * (request_.limit - 1) * distance;
    const double volume = volumeOf(sharp);
    const double growth = (volume - volumeOf(arcs)) * (request_.distance > 0 ? 1 : -1);
    return volume > 0 && growth > -request_.tolerance * area && growth < most;
  }

  [[nodiscard]] bool isMitre(const TopoDS_Shape& solid) const {
    if (!BRepCheck_Analyzer(solid).IsValid()) return false;
    TopTools_IndexedMapOfShape faces;
    TopExp::MapShapes(solid, TopAbs_FACE, faces);
    for (int f = 1; f <= faces.Extent(); ++f)
      for (const FaceSample& s : interiorSamples(TopoDS::Face(faces(f))))
        if (!mayLieOnMitre(s.point)) return false;
    // Corners reach farthest.
    TopTools_IndexedMapOfShape edges;
    TopExp::MapShapes(solid, TopAbs_EDGE, edges);
    for (int e = 1; e <= edges.Extent(); ++e) {
      const TopoDS_Edge& edge = TopoDS::Edge(edges(e));
      if (BRep_Tool::Degenerated(edge)) continue;
      const BRepAdaptor_Curve curve(edge);
      for (int i = 0; i < kEdgeSamples; ++i) {
        const double share = static_cast<double>(i) / (kEdgeSamples - 1);
        if (!mayLieOnMitre(
                curve.Value(std::lerp(curve.FirstParameter(), curve.LastParameter(), share))))
          return false;
      }
    }
    return true;
  }

  [[nodiscard]] bool mayLieOnMitre(const gp_Pnt& point) const {
    const TrueDistance::Foot foot = phi_.foot(Vec3(point.X(), point.Y(), point.Z()));
    const double wanted = std::abs(request_.distance);
    return foot.sign * request_.distance > 0 && foot.distance > wanted - request_.tolerance &&
           foot.distance < request_.limit * wanted + request_.tolerance;
  }

  const MitreRequest& request_;
  const TrueDistance& phi_;
  const Deadline& deadline_;
  double widestAngle_;  ///< rad, between the normals at an edge whose mitre is within the limit
};

}  // namespace

MitreJoin mitreJoin(const TopoDS_Shape& solid, const MitreRequest& request, const TrueDistance& phi,
                    const Deadline& deadline) {
  return MitreMaker(request, phi, deadline).make(solid);
}

}  // namespace phront::cad
