// Of the closed cells of a set of faces those inside (phi grows across their boundary outwards) are
// the offset. "Cells" is the second way: divide space by all pieces, keep the cells with phi < d,
// take the faces that bound exactly one of them; it survives tiny coinciding pieces that leave the
// first way open, and fails where one bad face lets two cells run into one.
#include "rebuild/assemble.h"

#include <BRepAdaptor_Curve.hxx>
#include <BRepBuilderAPI_Sewing.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <GCPnts_AbscissaPoint.hxx>
#include <ShapeFix_Shape.hxx>
#include <Standard_Failure.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_DataMapOfShapeInteger.hxx>
#include <TopTools_IndexedDataMapOfShapeListOfShape.hxx>
#include <TopTools_ListOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>
#include <TopoDS_Solid.hxx>
#include <algorithm>
#include <cmath>
#include <functional>

#include "exchange/measures.h"
#include "patches/patch_tools.h"
#include "rebuild/cells.h"
#include "rebuild/facet_gaps.h"
#include "rebuild/fill_gaps.h"
#include "rebuild/tiny_edges.h"
#include "rebuild/wide_vertices.h"

namespace phront::cad {
namespace {

/// Step across a face, of |d|, to see which way phi grows.
constexpr double kStep = 1e-3;
/// Pieces narrower than this share of the diagonal have no area: no file can carry them, and sewing
/// closes the gap they leave.
constexpr double kNoWidth = 1e-6;
/// Of |d|: edges known worse than this are not taken for the same, whatever lies between them.
constexpr double kMostBlurred = 0.05;
/// Of |d|: vertices known worse than this are looked at again.
constexpr double kWideVertex = 0.01;
/// Share of the live area that a complete result may leave out: doubles and strays.
constexpr double kUnusedArea = 5e-3;
/// How well a fitted patch meets its edges, of |d|, and how far it is sewn, in parts of that.
constexpr double kPatchTolerance = 1e-4;
constexpr double kPatchSewing = 3;
/// Solids thinner than this share of the diagonal (volume over area) have no volume.
constexpr double kNoVolume = 1e-7;

TopoDS_Shape asOne(const std::vector<TopoDS_Shape>& shapes) {
  if (shapes.empty()) return {};
  if (shapes.size() == 1) return shapes.front();
  const BRep_Builder builder;
  TopoDS_Compound compound;
  builder.MakeCompound(compound);
  for (const TopoDS_Shape& s : shapes) builder.Add(compound, s);
  return compound;
}

bool hasVolume(const TopoDS_Shape& solid, double diagonal) {
  return volumeOf(solid) > kNoVolume * diagonal * areaOf(solid);
}

/// Of the edges of a face: how long together, and how well they are known at worst.
struct Outline {
  double length = 0;
  double tolerance = 0;
};

Outline outlineOf(const TopoDS_Shape& face) {
  Outline outline;
  for (const TopoDS_Edge& edge : edgesOf(TopoDS::Face(face))) {
    if (BRep_Tool::Degenerated(edge)) continue;
    outline.length += GCPnts_AbscissaPoint::Length(BRepAdaptor_Curve(edge));
    outline.tolerance = std::max<double>(outline.tolerance, BRep_Tool::Tolerance(edge));
  }
  return outline;
}

class Assembler {
 public:
  Assembler(const std::vector<JudgedFace>& faces, const AssembleOptions& options,
            const TrueDistance& phi)
      : faces_(faces), options_(options), phi_(phi) {
    for (std::size_t i = 0; i < faces.size(); ++i) {
      index_.Bind(faces[i].face, static_cast<int>(i));
      if (!faces[i].live) continue;
      const double area = areaOf(faces[i].face);
      const Outline outline = outlineOf(faces[i].face);
      const double width = 2 * area / outline.length;
      if (!(width > kNoWidth * options.diagonal)) {
        hasSlivers_ = true;
        continue;
      }
      live_.push_back(faces[i].face);
      liveArea_ += area;
      if (width > outline.tolerance ||
          outline.tolerance > kMostBlurred * std::abs(options.distance))
        sharp_.push_back(faces[i].face);
      else
        blur_ = std::max(blur_, outline.tolerance);
    }
  }

  [[nodiscard]] bool mustSew() const { return hasSlivers_; }
  /// Are there pieces narrower than their edges are known?
  [[nodiscard]] bool isBlurred() const { return blur_ > 0; }

  /// Are there pieces that are not valid as they are? No way makes a valid solid of them.
  [[nodiscard]] bool hasFaultyPieces() const {
    return std::any_of(live_.begin(), live_.end(), [](const TopoDS_Shape& face) {
      return !BRepCheck_Analyzer(face).IsValid();
    });
  }

  /// Share of faces that say "this cell is inside". Dead faces lie wholly in phi < d; a live one
  /// says so when phi grows across it outwards.
  bool inside(const TopoDS_Shape& cell) {
    int yes = 0;
    int no = 0;
    for (TopExp_Explorer it(cell, TopAbs_FACE); it.More(); it.Next()) {
      std::vector<FaceSample> samples;
      bool live = true;
      if (index_.IsBound(it.Current())) {
        const JudgedFace& judged = faces_[static_cast<std::size_t>(index_.Find(it.Current()))];
        samples = judged.samples;
        live = judged.live;
        if (judged.face.Orientation() != it.Current().Orientation()) {
          for (FaceSample& s : samples) s.normal.Reverse();
        }
      } else {
        samples = interiorSamples(TopoDS::Face(it.Current()));
      }
      if (samples.empty()) continue;
      if (!live) {
        ++yes;
        continue;
      }
      const FaceSample& s = samples.front();
      const bool outward = facesOutward(s, s.normal, kStep * std::abs(options_.distance), phi_);
      ++(outward ? yes : no);
    }
    return yes > no;
  }

  /// Those of the cells that belong to the offset, as one shape.
  TopoDS_Shape insideOf(const std::vector<TopoDS_Shape>& cells) {
    std::vector<TopoDS_Shape> solids;
    for (const TopoDS_Shape& cell : cells) {
      if (inside(cell) && hasVolume(cell, options_.diagonal)) solids.push_back(cell);
    }
    return asOne(solids);
  }

  Assembly finish(const std::vector<TopoDS_Shape>& cells, const std::string& way) {
    Assembly result;
    result.way = way;
    result.shape = insideOf(cells);
    if (result.shape.IsNull()) return result;
    if (!BRepCheck_Analyzer(result.shape).IsValid()) repair(result);
    result.shape = withNarrowVertices(withoutTinyEdges(result.shape),
                                      kWideVertex * std::abs(options_.distance));
    result.openEdges = countOpenEdges(result.shape);
    // Of several solids one that does not close is simply not there.
    if (areaOf(result.shape) < (1 - kUnusedArea) * liveArea_) ++result.openEdges;
    return result;
  }

  /// Missing degenerated edges and loose tolerances are what is commonly wrong.
  void repair(Assembly& result) {
    ShapeFix_Shape fix(result.shape);
    fix.SetPrecision(1e-7 * options_.diagonal);
    fix.SetMaxTolerance(1e-4 * options_.diagonal);
    fix.Perform();
    const std::vector<TopoDS_Shape> solids = partsOf(fix.Shape(), TopAbs_SOLID);
    if (!solids.empty()) {
      result.shape = asOne(solids);
      result.way += ", repaired";
    }
  }

  Assembly fromPieces() { return finish(cellsOf(live_), "pieces"); }

  Assembly fromSewnPieces() {
    const double tolerance = std::max(options_.sewTolerance, kNoWidth * options_.diagonal);
    return finish(cellsOf(sewn(live_, tolerance)), "sewn pieces");
  }

  /// Without pieces that are narrower than their edges are known.
  Assembly fromSharpPieces() {
    return finish(cellsOf(sewn(sharp_, std::max(options_.sewTolerance, blur_))), "sharp pieces");
  }

  /// The pieces with fitted patches in their gaps; a null shape when there is a gap without.
  Assembly fromPatchedPieces() {
    std::vector<TopoDS_Face> faces;
    for (const TopoDS_Shape& face : live_) faces.push_back(TopoDS::Face(face));
    const double tolerance = kPatchTolerance * std::abs(options_.distance);
    const FilledGaps gaps = fillGaps(faces, {options_.distance, tolerance}, phi_);
    if ((gaps.patches.empty() && gaps.sewing == 0) || gaps.unfilled > 0) return {};
    std::vector<TopoDS_Shape> all(faces.begin(), faces.end());
    all.insert(all.end(), gaps.patches.begin(), gaps.patches.end());
    const double sewing = std::max({options_.sewTolerance, kPatchSewing * tolerance, gaps.sewing});
    Assembly result = finish(cellsOf(sewn(all, sewing)), "patched pieces");
    result.fittedFaces = static_cast<int>(gaps.patches.size());
    return result;
  }

  Result<Assembly> fromFacetedPieces(const FacetGapOptions& options, const IsoSurface& front) {
    std::vector<TopoDS_Face> faces;
    for (const TopoDS_Shape& face : live_) faces.push_back(TopoDS::Face(face));
    const Result<FacetedGaps> gaps = facetGaps(faces, options, front, phi_);
    if (!gaps) return tl::unexpected<Error>(gaps.error());
    const std::vector<TopoDS_Shape> all(gaps->faces.begin(), gaps->faces.end());
    double area = 0;
    for (const TopoDS_Shape& face : all) area += areaOf(face);
    // They were looked at as a file carries them: nothing is healed any more.
    Assembly result;
    result.way = "pieces and facets";
    std::vector<TopoDS_Shape> cells = cellsOf(all);
    for (TopoDS_Shape& cell : cells) cell = solidInReadingOrder(cell);
    result.shape = insideOf(cells);
    result.facetedFaces = gaps->curvedFacets;
    if (result.shape.IsNull() || countOpenEdges(result.shape) > 0 ||
        areaOf(result.shape) < (1 - kUnusedArea) * area)
      return fail(ErrorCode::Failed, "pieces and facets do not close");
    return result;
  }

  Assembly fromCells() {
    std::vector<TopoDS_Shape> all;
    for (const JudgedFace& j : faces_) all.push_back(j.face);
    TopTools_IndexedDataMapOfShapeListOfShape users;
    for (const TopoDS_Shape& cell : cellsOf(all)) {
      if (inside(cell)) TopExp::MapShapesAndAncestors(cell, TopAbs_FACE, TopAbs_SOLID, users);
    }
    std::vector<TopoDS_Shape> boundary;
    for (int i = 1; i <= users.Extent(); ++i) {
      if (users(i).Extent() == 1) boundary.push_back(users.FindKey(i));
    }
    return finish(cellsOf(boundary), "cells");
  }

 private:
  static std::vector<TopoDS_Shape> sewn(const std::vector<TopoDS_Shape>& faces, double tolerance) {
    BRepBuilderAPI_Sewing sewing(tolerance);
    for (const TopoDS_Shape& face : faces) sewing.Add(face);
    sewing.Perform();
    return partsOf(sewing.SewedShape(), TopAbs_FACE);
  }

  const std::vector<JudgedFace>& faces_;
  AssembleOptions options_;
  const TrueDistance& phi_;
  std::vector<TopoDS_Shape> live_;
  double liveArea_ = 0;
  std::vector<TopoDS_Shape> sharp_;  ///< of the live ones
  double blur_ = 0;                  ///< mm, of the others
  bool hasSlivers_ = false;
  TopTools_DataMapOfShapeInteger index_;
};

}  // namespace

Assembly assembleSolids(const std::vector<JudgedFace>& faces, const AssembleOptions& options,
                        const TrueDistance& phi) {
  Assembler assembler(faces, options, phi);
  std::vector<std::function<Assembly()>> ways;
  if (assembler.isBlurred()) ways.push_back([&] { return assembler.fromSharpPieces(); });
  if (!assembler.mustSew()) ways.push_back([&] { return assembler.fromPieces(); });
  if (options.sewTolerance > 0 || assembler.mustSew())
    ways.push_back([&] { return assembler.fromSewnPieces(); });
  ways.push_back([&] { return assembler.fromPatchedPieces(); });
  ways.push_back([&] { return assembler.fromCells(); });
  Assembly best;
  for (const auto& way : ways) {
    try {
      Assembly result = way();
      if (result.shape.IsNull()) continue;
      const bool closed = result.openEdges == 0;
      if (best.shape.IsNull() || result.openEdges < best.openEdges) best = std::move(result);
      if (closed && (BRepCheck_Analyzer(best.shape).IsValid() || assembler.hasFaultyPieces()))
        break;
    } catch (const Standard_Failure&) {
      continue;  // the next way
    }
  }
  return best;
}

Result<Assembly> assembleWithFacets(const std::vector<TopoDS_Face>& pieces,
                                    const AssembleOptions& options, const FacetGapOptions& facets,
                                    const IsoSurface& front, const TrueDistance& phi) {
  std::vector<JudgedFace> live;
  for (const TopoDS_Face& piece : pieces) {
    JudgedFace judged;
    judged.face = piece;
    judged.samples = interiorSamples(piece);
    judged.live = true;
    live.push_back(std::move(judged));
  }
  return Assembler(live, options, phi).fromFacetedPieces(facets, front);
}

Assembly assembleSheet(const std::vector<JudgedFace>& faces, const AssembleOptions& options,
                       const TrueDistance& phi) {
  BRepBuilderAPI_Sewing sewing(std::max(options.sewTolerance, kNoVolume * options.diagonal));
  for (const JudgedFace& j : faces) {
    if (!j.live) continue;
    const FaceSample& s = j.samples.front();
    const bool along = facesOutward(s, s.normal, kStep * std::abs(options.distance), phi);
    sewing.Add(along ? TopoDS_Shape(j.face) : j.face.Reversed());
  }
  sewing.Perform();
  Assembly result;
  result.way = "sewn sheet";
  result.shape = sewing.SewedShape();
  if (partsOf(result.shape, TopAbs_FACE).empty()) result.shape.Nullify();
  return result;
}

}  // namespace phront::cad
