// Topology of a result. An edge counts once per use by a face of its shell: twice is closed, also
// when one face uses it twice (seam). Degenerated edges have no length and internal or external
// ones bound nothing, so neither counts. Volume comes from the faces (divergence theorem,
// BRepGProp), solid by solid: a solid turned inside out must not hide behind a larger good one.
// Weak spot: BRepGProp returns huge numbers for some broken faces; a volume above that of the
// bounding box is therefore taken as no volume at all.
#include "judge/check_topology.h"

#include <BRepBndLib.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <BRepGProp.hxx>
#include <BRepMesh_IncrementalMesh.hxx>
#include <BRepTools.hxx>
#include <BRep_Tool.hxx>
#include <Bnd_Box.hxx>
#include <GProp_GProps.hxx>
#include <Poly_Triangulation.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "exchange/guard.h"
#include "exchange/measures.h"
#include "judge/widest_gap.h"
#include "tessellate/occt_mesh.h"

namespace phront::cad {
namespace {

constexpr double kUsualOfDiagonal = 1e-4;
constexpr double kUsualOfDistance = 0.02;
// Keeps the triangle count finite for tiny distances; coarser where no rounding can be missed.
constexpr double kFinestOfSolid = 2e-5;
constexpr double kFinestOfSheet = 5e-5;
constexpr double kAngle = 0.25;  // rad
constexpr double kCoarsestAngle = 1.6;
// What takes longer to mesh (a freeform sheet can have a million triangles) is tried by outlines.
constexpr double kPlainMeshSeconds = 10;
constexpr double kPlainMeshMiB = 2000;

// Bnd_Box encloses poles, not the surface itself, so it is never too small; the rest is round-off.
constexpr double kVolumeSlack = 1 + 1e-6;

// Triangles of a face that cover so much more or less than the face does have folded over it: of
// the area of all faces. Chords of curved faces make a thousandth.
constexpr double kFoldedArea = 0.01;
constexpr double kAreaAccuracy = 1e-4;

int countOf(const TopoDS_Shape& shape, TopAbs_ShapeEnum type) {
  TopTools_IndexedMapOfShape map;
  TopExp::MapShapes(shape, type, map);
  return map.Extent();
}

void countEdgeUses(const TopoDS_Shape& part, TopologyFigures& figures) {
  TopTools_IndexedMapOfShape edges;
  std::vector<int> uses;
  for (TopExp_Explorer f(part, TopAbs_FACE); f.More(); f.Next()) {
    for (TopExp_Explorer e(f.Current(), TopAbs_EDGE); e.More(); e.Next()) {
      const TopoDS_Edge& edge = TopoDS::Edge(e.Current());
      const TopAbs_Orientation side = edge.Orientation();
      if (side == TopAbs_INTERNAL || side == TopAbs_EXTERNAL) continue;
      if (BRep_Tool::Degenerated(edge)) continue;
      const auto index = static_cast<std::size_t>(edges.Add(edge));
      if (uses.size() < index) uses.push_back(0);
      ++uses[index - 1];
    }
  }
  for (const int n : uses) {
    if (n < 2) ++figures.freeEdges;
    if (n > 2) ++figures.overusedEdges;
  }
}

bool plausibleVolume(const TopoDS_Shape& solid, double volume) {
  if (!std::isfinite(volume) || volume <= 0) return false;
  Bnd_Box box;
  BRepBndLib::Add(solid, box, Standard_False);
  if (box.IsVoid()) return false;
  const gp_XYZ size = box.CornerMax().XYZ() - box.CornerMin().XYZ();
  return volume <= size.X() * size.Y() * size.Z() * kVolumeSlack;
}

double areaOfTriangles(const TopoDS_Face& face) {
  TopLoc_Location location;
  const Handle(Poly_Triangulation) triangles = BRep_Tool::Triangulation(face, location);
  double area = 0;
  for (int i = 1; !triangles.IsNull() && i <= triangles->NbTriangles(); ++i) {
    int a = 0;
    int b = 0;
    int c = 0;
    triangles->Triangle(i).Get(a, b, c);
    const gp_Pnt from = triangles->Node(a);
    const gp_Vec first(from, triangles->Node(b));
    const gp_Vec second(from, triangles->Node(c));
    area += 0.5 * first.Crossed(second).Magnitude();
  }
  return area;
}

/// The quick integral is some percent off where the outline has many splines.
double carefulArea(const TopoDS_Face& face) {
  GProp_GProps properties;
  BRepGProp::SurfaceProperties(face, properties, kAreaAccuracy);
  return std::abs(properties.Mass());
}

/// The faces of a shape that its triangles do not cover, or fold over.
class MeshedFaces {
 public:
  explicit MeshedFaces(const TopoDS_Shape& shape) {
    for (TopExp_Explorer f(shape, TopAbs_FACE); f.More(); f.Next()) {
      faces_.push_back(TopoDS::Face(f.Current()));
      areas_.push_back(areaOf(f.Current()));
      total_ += areas_.back();
    }
  }
  [[nodiscard]] int count() const { return static_cast<int>(faces_.size()); }
  void addMissing(std::set<int>& numbers) const {
    for (std::size_t i = 0; i < faces_.size(); ++i) {
      TopLoc_Location location;
      const Handle(Poly_Triangulation) triangles = BRep_Tool::Triangulation(faces_[i], location);
      if (triangles.IsNull() || triangles->NbTriangles() == 0) numbers.insert(static_cast<int>(i));
    }
  }
  void addFolded(std::set<int>& numbers) const {
    for (std::size_t i = 0; i < faces_.size(); ++i) {
      const double meshed = areaOfTriangles(faces_[i]);
      const auto isOff = [&](double area) {
        return meshed > 0 && std::abs(meshed - area) > kFoldedArea * total_;
      };
      if (isOff(areas_[i]) && isOff(carefulArea(faces_[i]))) numbers.insert(static_cast<int>(i));
    }
  }

 private:
  std::vector<TopoDS_Face> faces_;
  std::vector<double> areas_;
  double total_ = 0;
};

}  // namespace

TopologyFigures measureTopology(const TopoDS_Shape& shape) {
  TopologyFigures figures;
  if (shape.IsNull()) return figures;
  figures.solids = countOf(shape, TopAbs_SOLID);
  figures.faces = countOf(shape, TopAbs_FACE);
  figures.valid = BRepCheck_Analyzer(shape, Standard_True).IsValid();
  const WidestGap gap = widestGap(shape);
  figures.widestGap = gap.width;
  figures.atGap = gap.at;

  TopTools_IndexedMapOfShape shells;
  TopExp::MapShapes(shape, TopAbs_SHELL, shells);
  figures.shells = shells.Extent();
  for (int i = 1; i <= shells.Extent(); ++i) countEdgeUses(shells(i), figures);
  for (TopExp_Explorer f(shape, TopAbs_FACE, TopAbs_SHELL); f.More(); f.Next()) {
    ++figures.looseFaces;
  }

  for (TopExp_Explorer s(shape, TopAbs_SOLID); s.More(); s.Next()) {
    GProp_GProps properties;
    BRepGProp::VolumeProperties(s.Current(), properties, Standard_False);
    const double volume = properties.Mass();
    figures.volume += volume;
    if (!plausibleVolume(s.Current(), volume)) ++figures.badSolids;
  }
  return figures;
}

MeshSize meshSize(const OffsetScale& scale, double shareOfDiagonal, double shareOfDistance) {
  const double radius = std::abs(scale.distance);
  const double finest = scale.solid ? kFinestOfSolid : kFinestOfSheet;
  const double deflection =
      std::max(std::min(shareOfDiagonal * scale.diagonal, shareOfDistance * radius),
               finest * scale.diagonal);
  const double height = std::min(deflection / radius, 1 - std::cos(0.5 * kCoarsestAngle));
  return {deflection, std::max(kAngle, 2 * std::acos(1 - height))};
}

MeshSize usualMeshSize(const OffsetScale& scale) {
  return meshSize(scale, kUsualOfDiagonal, kUsualOfDistance);
}

std::vector<int> facesWithoutTriangles(const TopoDS_Shape& shape, const MeshSize& size) {
  // Where an outline nearly touches itself it is a matter of luck which angle fails.
  const std::set<double> angles{kAngle, size.angle};
  BRepTools::Clean(shape);
  const MeshedFaces faces(shape);
  const Result<std::string> plain =
      runInChild("meshing", {kPlainMeshSeconds, kPlainMeshMiB}, [&]() -> Result<std::string> {
        std::set<int> faulty;
        for (const double angle : angles) {
          BRepTools::Clean(shape);
          BRepMesh_IncrementalMesh(shape, size.deflection, Standard_False, angle, Standard_False);
          faces.addMissing(faulty);
          faces.addFolded(faulty);
        }
        std::string numbers;
        for (const int number : faulty) numbers += std::to_string(number) + ' ';
        return numbers;
      });
  std::set<int> faulty;
  if (plain) {
    std::istringstream numbers(*plain);
    for (int number = 0; numbers >> number;) faulty.insert(number);
  } else if (plain.error().code == ErrorCode::ResourceLimit) {
    meshOutlines(shape, size.deflection, size.angle);
    faces.addMissing(faulty);
    BRepTools::Clean(shape);
  } else {
    for (int number = 0; number < faces.count(); ++number) faulty.insert(number);
  }
  return {faulty.begin(), faulty.end()};
}

}  // namespace phront::cad
