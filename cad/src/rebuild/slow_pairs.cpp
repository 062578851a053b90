// A child tries one pair after the other and says in shared memory which it is at. It stops by
// itself after a short while and says how far it came; one that does not is stuck in the pair it
// named last, and the next child begins behind that.
#include "rebuild/slow_pairs.h"

#include <sys/mman.h>
#include <BRepAdaptor_Surface.hxx>
#include <BRepBndLib.hxx>
#include <Bnd_Box.hxx>
#include <IntTools_FaceFace.hxx>
#include <Standard_Failure.hxx>
#include <atomic>
#include <chrono>
#include <new>
#include <string>

#include "deadline.h"
#include "exchange/guard.h"

namespace phront::cad {
namespace {

constexpr double kBatchSeconds = 1;
constexpr double kSlowSeconds = 2;  // on top: the pair is given up
constexpr double kMemoryMiB = 1500;
constexpr std::size_t kMostSlow = 12;  // with more of them the rest counts as slow, too

using Pair = std::pair<std::size_t, std::size_t>;

bool isQuadric(const TopoDS_Face& face) {
  const GeomAbs_SurfaceType type = BRepAdaptor_Surface(face, Standard_False).GetType();
  return type == GeomAbs_Plane || type == GeomAbs_Cylinder || type == GeomAbs_Cone ||
         type == GeomAbs_Sphere;
}

std::vector<Pair> candidates(const std::vector<TopoDS_Face>& faces, const MayCross& mayCross) {
  std::vector<Bnd_Box> boxes(faces.size());
  std::vector<char> quadric;
  for (std::size_t i = 0; i < faces.size(); ++i) {
    BRepBndLib::Add(faces[i], boxes[i], Standard_False);
    quadric.push_back(isQuadric(faces[i]) ? 1 : 0);
  }
  std::vector<Pair> pairs;
  for (std::size_t i = 0; i < faces.size(); ++i)
    for (std::size_t j = i + 1; j < faces.size(); ++j)
      if (!(quadric[i] && quadric[j]) && !boxes[i].IsOut(boxes[j]) && mayCross(i, j))
        pairs.emplace_back(i, j);
  return pairs;
}

void intersect(const TopoDS_Face& a, const TopoDS_Face& b) {
  constexpr double kTolerance = 1e-7;
  IntTools_FaceFace intersection;
  intersection.SetParameters(Standard_True, Standard_True, Standard_True, kTolerance);
  try {
    intersection.Perform(a, b);
  } catch (const Standard_Failure&) {
    return;  // the filler has its own way with these
  }
}

}  // namespace

std::set<Pair> slowPairs(const std::vector<TopoDS_Face>& faces, const MayCross& mayCross) {
  const std::vector<Pair> pairs = candidates(faces, mayCross);
  std::set<Pair> slow;
  void* memory = ::mmap(nullptr, sizeof(std::atomic<std::size_t>), PROT_READ | PROT_WRITE,
                        MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED) return slow;
  auto* at = new (memory) std::atomic<std::size_t>(0);
  for (std::size_t next = 0; next < pairs.size();) {
    if (slow.size() >= kMostSlow) {
      slow.insert(pairs.begin() + static_cast<std::ptrdiff_t>(next), pairs.end());
      break;
    }
    Pulse::beat();
    *at = next;
    const Result<std::string> end =
        runInChild("intersecting faces", {kBatchSeconds + kSlowSeconds, kMemoryMiB},
                   [&]() -> Result<std::string> {
                     const auto start = std::chrono::steady_clock::now();
                     std::size_t k = next;
                     for (; k < pairs.size() && secondsSince(start) < kBatchSeconds; ++k) {
                       *at = k;
                       intersect(faces[pairs[k].first], faces[pairs[k].second]);
                     }
                     return std::to_string(k);
                   });
    if (end) {
      next = std::stoul(*end);
      continue;
    }
    if (end.error().code == ErrorCode::Cancelled) break;
    slow.insert(pairs[*at]);
    next = *at + 1;
  }
  ::munmap(memory, sizeof(std::atomic<std::size_t>));
  Pulse::rest();
  return slow;
}

}  // namespace phront::cad
