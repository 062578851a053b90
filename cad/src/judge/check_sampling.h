// Building blocks of the check: distance to a whole model, stratified samples of its surface,
// points of its true offset, percentiles by weight. They know nothing of how a result was made.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "phront/cad/shape.h"
#include "phront/status.h"
#include "tessellate/true_distance.h"

namespace phront::cad {

/// Uniform numbers in [0, 1) with the same bits on every standard library.
class SampleRng {
 public:
  explicit SampleRng(std::uint64_t seed) : engine_(seed) {}
  double operator()() { return static_cast<double>(engine_() >> 11) * 0x1.0p-53; }

 private:
  std::mt19937_64 engine_;
};

/// Errors with the area they stand for.
class WeightedErrors {
 public:
  void add(double error, double weight);  ///< NaN counts as infinite
  [[nodiscard]] bool empty() const { return items_.empty(); }
  [[nodiscard]] double max() const;  ///< 0 when empty
  [[nodiscard]] double quantile(
      double fraction) const;  ///< smallest error that `fraction` stays below
  [[nodiscard]] double shareAbove(double bound) const;  ///< of the weight, in [0, 1]

 private:
  struct Item {
    double error;
    double weight;
  };
  std::vector<Item> items_;
};

/// A point on the exact surface of a model.
struct SurfaceSample {
  std::size_t body = 0;
  Index triangle = kNone;
  Vec3 point = Vec3::Zero();
  Vec3 normal = Vec3::Zero();  ///< unit, towards phi > 0
  double weight = 0;           ///< area it stands for, mm^2
};

/// All bodies of a model together, ready for distance queries. Not thread safe.
class ModelDistance {
 public:
  /// `what` names the model in the sentence of an Error ("the input"). Bodies without a shape are
  /// skipped.
  [[nodiscard]] static Result<ModelDistance> build(const std::vector<Body>& bodies,
                                                   const TessellateOptions& options,
                                                   const std::string& what);

  /// Of one body whose distance is known already.
  [[nodiscard]] static Result<ModelDistance> of(const Body& body,
                                                std::shared_ptr<const TrueDistance> distance);

  [[nodiscard]] double distance(const Vec3& x) const;      ///< to the exact shape, >= 0
  [[nodiscard]] double meshDistance(const Vec3& x) const;  ///< to the triangles, >= 0
  [[nodiscard]] bool inside(const Vec3& x) const;          ///< inside any solid, by winding number
  [[nodiscard]] bool inside(std::size_t body, const Vec3& x) const;  ///< inside that one, a solid
  /// Of sheets: does x lie on the side of the normal of the nearest face? nullopt where its foot is
  /// on an edge or vertex: beside a free edge there is no side, beside slivers none to rely on.
  [[nodiscard]] std::optional<bool> beforeSheet(const Vec3& x) const;
  /// Do solids overlap at this triangle, themselves or one another: is its outer side inside one,
  /// or its inner side inside two? False on sheets.
  [[nodiscard]] bool buried(std::size_t body, Index triangle) const;

  [[nodiscard]] std::size_t bodyCount() const { return parts_.size(); }
  [[nodiscard]] bool isSolid(std::size_t i) const { return parts_[i].solid; }
  [[nodiscard]] const TrueDistance& body(std::size_t i) const { return *parts_[i].distance; }
  [[nodiscard]] const TopoDS_Shape& shape(std::size_t i) const { return parts_[i].shape; }
  [[nodiscard]] bool hasSolids() const { return hasSolids_; }
  [[nodiscard]] double area() const { return area_; }              ///< of the triangles, mm^2
  [[nodiscard]] double deflection() const { return deflection_; }  ///< measured, mm
  [[nodiscard]] const Box3& box() const { return box_; }           ///< of the triangles
  [[nodiscard]] int faces() const { return faces_; }
  [[nodiscard]] int untessellatedFaces() const { return untessellated_; }

  /// Sample at barycentric coordinates of a triangle, on the exact face.
  [[nodiscard]] SurfaceSample sampleAt(std::size_t body, Index triangle, const Vec3& bary) const;

  /// Stratified by area inside each face: max(perFace, count * area of face / area) samples each.
  [[nodiscard]] std::vector<SurfaceSample> surfaceSamples(int count, int perFace,
                                                          SampleRng& rng) const;

 private:
  /// `deflection`: mm, that was asked for, if known: the measured one is from samples.
  void add(const Body& body, std::shared_ptr<const TrueDistance> distance, double deflection);
  [[nodiscard]] Result<ModelDistance> finished(const std::string& what) &&;
  [[nodiscard]] double winding(const Vec3& x) const;  // of all solids together

  struct Part {
    TopoDS_Shape shape;
    bool solid = false;
    bool planar = false;  ///< the triangles are the exact shape
    std::shared_ptr<const TrueDistance> distance;
    double slack = 0;  ///< how far the exact shape may lie outside the box of its triangles, mm
  };
  std::vector<Part> parts_;
  bool hasSolids_ = false;
  Box3 box_;
  double area_ = 0;
  double deflection_ = 0;
  int faces_ = 0;
  int untessellated_ = 0;
};

/// A point of the offset built from one face, edge or vertex alone, before other features cut it
/// off.
struct OffsetCandidate {
  Vec3 point = Vec3::Zero();
  double weight = 0;     ///< area of the offset it stands for, mm^2
  bool rounded = false;  ///< from an edge or vertex: may lie on the wrong side
};

/// How densely edges and vertices are sampled.
struct RoundingDensity {
  double perArea = 0;  ///< samples per mm^2 of the arc strips
  int perVertex = 16;  ///< directions in each normal cone
};

/// Arcs between the two face normals along every edge, and random directions in the normal cone of
/// every vertex, all at |distance|. Pipes of smooth edges are left out: they have no area.
[[nodiscard]] std::vector<OffsetCandidate> roundingCandidates(const TopoDS_Shape& shape,
                                                              double distance,
                                                              const RoundingDensity& density,
                                                              SampleRng& rng);

}  // namespace phront::cad
