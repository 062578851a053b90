// Every point of the offset has its foot in a face, inside an edge or at a vertex: the union of the
// offset faces, pipes and sphere patches contains the offset and needs no extension (Rossignac &
// Requicha 1986, "Offsetting operations in solid modelling"). Concave edges need nothing, the
// patches beside them cross. Patches that are neighbours by construction share their edges, so
// their tangential contacts are never intersected.
#include "patches/raw_complex.h"

#include <BRep_Tool.hxx>
#include <Standard_Failure.hxx>
#include <TopExp.hxx>
#include <cmath>
#include <optional>
#include <set>

#include "exchange/tolerances.h"
#include "patches/edge_table.h"
#include "patches/mouth_pipes.h"
#include "patches/offset_face.h"
#include "patches/patch_tools.h"
#include "patches/pipe.h"
#include "patches/rims.h"
#include "patches/sphere_patch.h"

namespace phront::cad {
namespace {

TopoDS_Edge imageOf(const std::vector<FaceImage>& images, int face, int edge) {
  const auto& edges = images[static_cast<std::size_t>(face)].edges;
  const auto it = edges.find(edge);
  return it == edges.end() ? TopoDS_Edge() : it->second;
}

class Builder {
 public:
  Builder(const DividedRims& divided, const RawOptions& options)
      : options_(options),
        radius_(std::abs(options.distance)),
        tips_(divided.tips),
        table_(makeEdgeTable(divided.shape, options.distance > 0 ? 1 : -1, options.smoothAngle)),
        vertices_(table_, options.distance, options.smoothAngle) {}

  /// First: the faces and the pipes of narrow mouths. Returns the rims that have none such: they
  /// had better not been divided.
  [[nodiscard]] std::set<std::size_t> addFacesAndMouths() {
    images_ = offsetFaces(table_, vertices_, options_.distance, options_.tolerance, arcs_, apices_,
                          raw_.notes);
    for (const FaceImage& image : images_) {
      if (!image.face.IsNull() && !image.dead) raw_.faces.push_back(image.face);
      raw_.faces.insert(raw_.faces.end(), image.pieces.begin(), image.pieces.end());
      if (image.face.IsNull() && !image.dead && !image.inPieces) ++raw_.missing;
    }
    std::set<std::size_t> without;
    for (const RimTips& tips : tips_)
      if (!addMouth(tips)) without.insert(tips.rim);
    return without;
  }

  /// Then the rest.
  RawComplex run() {
    for (std::size_t e = 0; e < table_.edges.size(); ++e) {
      if (table_.edges[e].pipe) addPipe(static_cast<int>(e));
    }
    for (std::size_t v = 0; v < table_.edgesAt.size(); ++v) addSphere(static_cast<int>(v));
    settleTolerances(raw_.faces);
    if (table_.nonManifold > 0) {
      raw_.notes.push_back(std::to_string(table_.nonManifold) +
                           " edges with more than two faces got no pipe");
    }
    if (lostPipes_ > 0) raw_.notes.push_back(std::to_string(lostPipes_) + " pipes not built");
    if (lostSpheres_ > 0) {
      raw_.notes.push_back(std::to_string(lostSpheres_) + " sphere patches not built");
    }
    return std::move(raw_);
  }

 private:
  [[nodiscard]] PipeFrame frameOf(int e) const {
    const EdgeInfo& info = table_.edges[static_cast<std::size_t>(e)];
    TopoDS_Vertex first;
    TopoDS_Vertex last;
    TopExp::Vertices(info.edge, first, last);
    return {&info,
            radius_,
            options_.tolerance,
            imageOf(images_, info.face1, e),
            imageOf(images_, info.face2, e),
            vertices_.image(first, info.face1, e),
            vertices_.image(first, info.face2, e),
            vertices_.image(last, info.face1, e),
            vertices_.image(last, info.face2, e)};
  }

  bool addMouth(const RimTips& tips) {
    const std::optional<std::pair<RimHalf, RimHalf>> halves = rimHalves(table_, tips);
    if (!halves) return false;
    const auto framesOf = [&](const RimHalf& half) {
      std::vector<MouthEdge> edges;
      for (const RimEdge& use : half) edges.push_back({frameOf(use.edge), use.forward});
      return edges;
    };
    std::vector<TopoDS_Face> faces;
    try {
      faces = mouthPipes(framesOf(halves->first), framesOf(halves->second), arcs_);
    } catch (const Standard_Failure&) {
      return false;
    }
    if (faces.empty()) return false;
    raw_.faces.insert(raw_.faces.end(), faces.begin(), faces.end());
    for (const RimHalf& half : {halves->first, halves->second})
      for (const RimEdge& use : half) inMouth_.insert(use.edge);
    return true;
  }

  void addPipe(int e) {
    if (inMouth_.count(e) > 0) return;
    const PipeFrame frame = frameOf(e);
    try {
      std::optional<std::vector<TopoDS_Face>> faces = linePipe(frame, arcs_);
      if (!faces) faces = circlePipe(frame, arcs_, apices_);
      if (!faces && !frame.image1.IsNull() && !frame.image2.IsNull()) {
        faces = std::vector<TopoDS_Face>{sweptPipe(frame, arcs_)};
      }
      if (faces) {
        raw_.faces.insert(raw_.faces.end(), faces->begin(), faces->end());
        return;
      }
    } catch (const Standard_Failure&) {
      // Counted below: the attempt goes on, its judge will see the hole if it matters.
    }
    ++lostPipes_;
    ++raw_.missing;
  }

  void addSphere(int v) {
    try {
      const TopoDS_Face face =
          spherePatch(table_, table_.edgesAt[static_cast<std::size_t>(v)], vertices_, v,
                      openedAt(v), radius_, options_.tolerance, arcs_);
      if (!face.IsNull()) raw_.faces.push_back(face);
    } catch (const Standard_Failure&) {
      ++lostSpheres_;
      ++raw_.missing;
    }
  }

  /// What the poles at a vertex have opened into.
  [[nodiscard]] std::vector<TopoDS_Edge> openedAt(int v) const {
    std::vector<TopoDS_Edge> opened;
    for (const OpenPole& pole : vertices_.poles()) {
      if (pole.vertex != v) continue;
      const TopoDS_Edge edge = imageOf(images_, pole.face, pole.edge);
      if (!edge.IsNull() && !BRep_Tool::Degenerated(edge)) opened.push_back(edge);
    }
    return opened;
  }

  RawOptions options_;
  double radius_;
  std::vector<RimTips> tips_;
  EdgeTable table_;
  VertexImages vertices_;
  std::vector<FaceImage> images_;
  ArcPool arcs_;
  PointPool apices_;
  std::set<int> inMouth_;  ///< edges that have their pipes
  RawComplex raw_;
  int lostPipes_ = 0;
  int lostSpheres_ = 0;
};

}  // namespace

RawComplex buildRawComplex(const TopoDS_Shape& healed, const RawOptions& options) {
  const auto divide = [&](const std::set<std::size_t>& leaveOut) {
    try {
      return divideRims(healed, options.distance, options.smoothAngle, leaveOut);
    } catch (const Standard_Failure&) {
      return DividedRims{healed, {}};  // the pipes of narrow mouths are then left to General Fuse
    }
  };
  std::optional<Builder> builder;
  std::set<std::size_t> leaveOut;
  for (bool again = true; again;) {
    builder.emplace(divide(leaveOut), options);
    const std::set<std::size_t> without = builder->addFacesAndMouths();
    again = !without.empty();
    leaveOut.insert(without.begin(), without.end());
  }
  return builder->run();
}

}  // namespace phront::cad
