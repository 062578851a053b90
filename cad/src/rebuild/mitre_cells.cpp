// The faces of a mitre are those of the offset, extended: every cell between extended faces lies
// wholly inside the mitre or wholly outside of it. A growing mitre holds the offset, so its cells
// are those with points nearer to the part than |d|; a shrinking one is held by it, and its cells
// are those without such points. Weak spot: a tip cut off by a face that was extended too far has
// no such point of its own and is lost; the volume stays between that of the arcs and the mitre.
#include "rebuild/mitre_cells.h"

#include <BOPAlgo_MakerVolume.hxx>
#include <BRepAdaptor_Surface.hxx>
#include <BRepClass3d_SolidClassifier.hxx>
#include <BRepLib.hxx>
#include <Precision.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopTools_ListOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Face.hxx>
#include <cmath>

#include "patches/patch_tools.h"
#include "rebuild/cells.h"
#include "rebuild/select.h"

namespace phront::cad {
namespace {

constexpr double kStep = 0.05;    // of |d|: from a face into its cell
constexpr double kNearer = 0.99;  // of |d|: clearly nearer
constexpr double kPitch = 0.5;    // of |d|: where few points of a face do not tell

TopTools_ListOfShape withExtendedFaces(const TopoDS_Shape& solid,
                                       const std::vector<TopoDS_Shape>& round, double extension) {
  TopTools_IndexedMapOfShape gone;
  TopTools_IndexedMapOfShape border;
  for (const TopoDS_Shape& face : round) {
    gone.Add(face);
    for (const TopoDS_Edge& edge : edgesOf(TopoDS::Face(face))) border.Add(edge);
  }
  TopTools_ListOfShape faces;
  TopTools_IndexedMapOfShape all;
  TopExp::MapShapes(solid, TopAbs_FACE, all);
  for (int f = 1; f <= all.Extent(); ++f) {
    if (gone.Contains(all(f))) continue;
    const TopoDS_Face& face = TopoDS::Face(all(f));
    bool beside = false;
    for (const TopoDS_Edge& edge : edgesOf(face)) beside = beside || border.Contains(edge);
    TopoDS_Face extended = face;
    if (beside) BRepLib::ExtendFace(face, extension, true, true, true, true, extended);
    faces.Append(extended);
  }
  return faces;
}

class CellChooser {
 public:
  CellChooser(double distance, const TrueDistance& phi) : distance_(distance), phi_(phi) {}

  [[nodiscard]] bool belongs(const TopoDS_Shape& cell) const {
    return (distance_ > 0) == reachesPart(cell);
  }

 private:
  [[nodiscard]] bool reachesPart(const TopoDS_Shape& cell) const {
    BRepClass3d_SolidClassifier classifier(cell);
    const auto tells = [&](const gp_Pnt& onFace, const gp_Vec& outward) {
      const gp_Pnt p = onFace.Translated(outward * (-kStep * std::abs(distance_)));
      const double height = phi_.signedDistance(Vec3(p.X(), p.Y(), p.Z()));
      if (distance_ > 0 ? height >= kNearer * distance_ : height <= kNearer * distance_)
        return false;
      classifier.Perform(p, Precision::Confusion());
      return classifier.State() == TopAbs_IN;
    };
    const std::vector<TopoDS_Face> walls = wallsOf(cell);
    for (const TopoDS_Face& face : walls)
      for (const FaceSample& s : interiorSamples(face))
        if (tells(s.point, s.normal)) return true;
    for (const TopoDS_Face& face : walls) {
      const BRepAdaptor_Surface surface(face);
      for (const gp_Pnt2d& uv : gridInside(face, kPitch * std::abs(distance_))) {
        const std::optional<gp_Vec> normal = outwardNormal(face, uv);
        if (normal && tells(surface.Value(uv.X(), uv.Y()), *normal)) return true;
      }
    }
    return false;
  }

  double distance_;
  const TrueDistance& phi_;
};

}  // namespace

TopoDS_Shape mitreOfCells(const TopoDS_Shape& solid, const std::vector<TopoDS_Shape>& round,
                          double extension, double distance, const TrueDistance& phi) {
  BOPAlgo_MakerVolume cells;
  cells.SetArguments(withExtendedFaces(solid, round, extension));
  cells.SetIntersect(true);
  cells.Perform();
  if (cells.HasErrors()) return {};

  const CellChooser chooser(distance, phi);
  std::vector<TopoDS_Shape> chosen;
  for (TopExp_Explorer cell(cells.Shape(), TopAbs_SOLID); cell.More(); cell.Next())
    if (chooser.belongs(cell.Current())) chosen.push_back(cell.Current());
  TopTools_ListOfShape skin;
  for (const TopoDS_Face& face : skinOf(chosen)) skin.Append(face);
  if (skin.IsEmpty()) return {};
  BOPAlgo_MakerVolume whole;
  whole.SetArguments(skin);
  whole.SetIntersect(false);
  whole.Perform();
  return whole.HasErrors() ? TopoDS_Shape() : whole.Shape();
}

}  // namespace phront::cad
