// The offset of a face needs no trimming against its neighbours: its image over the original (u,v)
// domain already contains all of the true offset that stems from it, because the foot of a point of
// the offset lies in the face. Images of vertices and of smooth edges are made once and shared, so
// that neighbours by construction meet topologically.
// Weak spot: a freeform face with curvature radius below |d| in a part of it has an image that cuts
// itself; the selection cannot see that.
#include "patches/offset_face.h"

#include <BRepAdaptor_Surface.hxx>
#include <BRepLib.hxx>
#include <BRepOffset_Offset.hxx>
#include <BRep_Tool.hxx>
#include <Geom2d_Curve.hxx>
#include <Precision.hxx>
#include <Standard_Failure.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_DataMapOfShapeShape.hxx>
#include <TopoDS.hxx>
#include <algorithm>
#include <cmath>
#include <gp_Cylinder.hxx>
#include <gp_Sphere.hxx>
#include <gp_Torus.hxx>

#include "exchange/tolerances.h"
#include "patches/axis_trim.h"
#include "patches/open_pole.h"
#include "patches/patch_tools.h"

namespace phront::cad {
namespace {

/// New radius of a cylinder, a sphere or of a torus's tube; empty for other surfaces.
std::optional<double> offsetRadius(const TopoDS_Face& face, double distance) {
  const BRepAdaptor_Surface surface(face, Standard_False);
  const double u = (surface.FirstUParameter() + surface.LastUParameter()) / 2;
  const double v = (surface.FirstVParameter() + surface.LastVParameter()) / 2;
  const gp_Pnt p = surface.Value(u, v);
  double radius = 0;
  gp_Vec outward;
  switch (surface.GetType()) {
    case GeomAbs_Cylinder: {
      const gp_Cylinder cylinder = surface.Cylinder();
      radius = cylinder.Radius();
      const gp_Vec arm(cylinder.Location(), p);
      const gp_Vec axis(cylinder.Axis().Direction());
      outward = arm - axis * arm.Dot(axis);
      break;
    }
    case GeomAbs_Sphere:
      radius = surface.Sphere().Radius();
      outward = gp_Vec(surface.Sphere().Location(), p);
      break;
    case GeomAbs_Torus: {
      const gp_Torus torus = surface.Torus();
      radius = torus.MinorRadius();
      const gp_Vec arm(torus.Location(), p);
      const gp_Vec axis(torus.Axis().Direction());
      gp_Vec radial = arm - axis * arm.Dot(axis);
      radial.Normalize();
      outward = arm - radial * torus.MajorRadius();
      break;
    }
    default:
      return std::nullopt;
  }
  const std::optional<gp_Vec> normal = outwardNormal(face, gp_Pnt2d(u, v));
  if (!normal) return std::nullopt;
  return normal->Dot(outward) > 0 ? radius + distance : radius - distance;
}

/// Edges of the image in the order of the original's.
void collectEdges(const EdgeTable& table, const TopoDS_Face& face, FaceImage& image) {
  TopExp_Explorer original(face.Oriented(TopAbs_FORWARD), TopAbs_EDGE);
  TopExp_Explorer offset(image.face.Oriented(TopAbs_FORWARD), TopAbs_EDGE);
  for (; original.More() && offset.More(); original.Next(), offset.Next()) {
    const int e = table.edgeIndex.FindIndex(original.Current()) - 1;
    image.edges[e] = TopoDS::Edge(offset.Current().Oriented(TopAbs_FORWARD));
  }
}

void shareSmooth(const EdgeTable& table, const FaceImage& image,
                 std::map<int, TopoDS_Edge>& shared) {
  for (const auto& [e, edge] : image.edges) {
    if (table.edges[static_cast<std::size_t>(e)].smooth) shared.try_emplace(e, edge);
  }
}

}  // namespace

std::vector<FaceImage> offsetFaces(const EdgeTable& table, const VertexImages& vertices,
                                   double distance, double tolerance, ArcPool& arcs,
                                   PointPool& points, std::vector<std::string>& notes) {
  std::vector<FaceImage> images(table.faces.size());
  std::map<int, TopoDS_Edge> shared;
  int lost = 0;
  int dead = 0;
  int cut = 0;
  for (std::size_t f = 0; f < table.faces.size(); ++f) {
    const TopoDS_Face& face = table.faces[f];
    FaceImage& image = images[f];
    const std::optional<double> radius = offsetRadius(face, distance);
    image.dead = radius && *radius < tolerance;
    dead += image.dead ? 1 : 0;
    if (radius && std::abs(*radius) < tolerance) continue;

    if (std::optional<TrimmedImage> trimmed = trimAtAxis(
            table, static_cast<int>(f), vertices, distance, tolerance, shared, arcs, points)) {
      image.inPieces = true;
      image.pieces = std::move(trimmed->faces);
      image.pieces.insert(image.pieces.end(), trimmed->caps.begin(), trimmed->caps.end());
      image.edges = std::move(trimmed->edges);
      shareSmooth(table, image, shared);
      ++cut;
      continue;
    }

    TopTools_DataMapOfShapeShape created;
    for (const TopoDS_Edge& edge : edgesOf(face)) {
      const int e = table.edgeIndex.FindIndex(edge) - 1;
      const auto known = shared.find(e);
      if (known != shared.end() && !created.IsBound(edge)) created.Bind(edge, known->second);
      TopoDS_Vertex ends[2];
      TopExp::Vertices(edge, ends[0], ends[1]);
      for (const TopoDS_Vertex& end : ends) {
        if (end.IsNull() || created.IsBound(end)) continue;
        if (vertices.poleAt(end, static_cast<int>(f)) != nullptr) continue;
        const TopoDS_Vertex vertex = vertices.image(end, static_cast<int>(f), e);
        if (!vertex.IsNull()) created.Bind(end, vertex);
      }
    }
    try {
      const BRepOffset_Offset offset(face, distance, created, Standard_True, GeomAbs_Arc);
      image.face = offset.Face();
      if (image.face.IsNull() || offset.Status() == BRepOffset_Degenerated) {
        image.face.Nullify();
        if (!image.dead) ++lost;
        continue;
      }
      for (const OpenPole& pole : vertices.poles())
        if (pole.face == static_cast<int>(f))
          image.face = openPole(table, pole, vertices, image.face);
      BRepLib::BuildCurves3d(image.face, tolerance);
      for (const TopoDS_Edge& edge : edgesOf(image.face)) raiseTolerance(edge, image.face);
      collectEdges(table, face, image);
    } catch (const Standard_Failure&) {
      image = FaceImage();
      ++lost;
      continue;
    }
    shareSmooth(table, image, shared);
  }
  if (cut > 0) notes.push_back(std::to_string(cut) + " faces end at their axis");
  if (dead > 0) notes.push_back(std::to_string(dead) + " faces with radius below |d| vanish");
  if (lost > 0) notes.push_back(std::to_string(lost) + " faces have no offset surface");
  return images;
}

}  // namespace phront::cad
