// The fence must hold against all that OpenCASCADE was seen to do.
#include "exchange/guard.h"

#include <dirent.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <BRepAlgoAPI_Fuse.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeTorus.hxx>
#include <BRepTools.hxx>
#include <BRep_Tool.hxx>
#include <Message.hxx>
#include <Standard_DomainError.hxx>
#include <TopExp.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <iostream>
#include <string>
#include <thread>
#include <vector>

#include "exchange/hang_fence.h"
#include "exchange/shape_bytes.h"

namespace phront::cad {
namespace {

constexpr GuardLimits kShort{.seconds = 20, .memoryMiB = 1024};

double secondsOf(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

int openDescriptors() {
  int count = 0;
  DIR* folder = ::opendir("/proc/self/fd");
  while (::readdir(folder)) ++count;
  ::closedir(folder);
  return count;
}

// Endless, but not so that a compiler may see it and drop it.
int recurse(volatile int* depth) {
  volatile char block[256] = {};
  *depth = *depth + 1;
  return *depth < 0 ? block[0] : recurse(depth) + block[1];
}

std::string messageOf(const std::function<Result<std::string>()>& work,
                      const GuardLimits& limits = kShort) {
  const Result<std::string> result = runInChild("reading a.step", limits, work);
  return result ? "no error" : result.error().message;
}

TEST(Guard, BringsBytesHome) {
  std::string big(3 << 20, 'x');
  big[5] = '\0';
  const auto result = runInChild("test", kShort, [&]() -> Result<std::string> { return big; });
  ASSERT_TRUE(result);
  EXPECT_EQ(*result, big);
  const auto empty = runInChild("test", kShort, []() -> Result<std::string> { return ""; });
  ASSERT_TRUE(empty);
  EXPECT_TRUE(empty->empty());
}

TEST(Guard, BringsErrorsHome) {
  const auto result = runInChild("test", kShort, []() -> Result<std::string> {
    return fail(ErrorCode::UnreadableInput, "no geometry", "line 7");
  });
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, ErrorCode::UnreadableInput);
  EXPECT_EQ(result.error().message, "no geometry");
  EXPECT_EQ(result.error().where, "line 7");
}

TEST(Guard, TurnsExceptionsIntoSentences) {
  EXPECT_EQ(messageOf([]() -> Result<std::string> { throw Standard_DomainError("bad knots"); }),
            "reading a.step: OpenCASCADE failed (Standard_DomainError: bad knots)");
  EXPECT_EQ(messageOf([]() -> Result<std::string> { throw std::runtime_error("bad byte"); }),
            "reading a.step failed (bad byte)");
  EXPECT_EQ(messageOf([]() -> Result<std::string> { throw 3; }),
            "reading a.step failed for an unknown reason");
}

TEST(Guard, SurvivesSignalsAndExits) {
  EXPECT_EQ(messageOf([]() -> Result<std::string> {
              ::raise(SIGSEGV);
              return "";
            }),
            "reading a.step: OpenCASCADE crashed (segmentation fault)");
  EXPECT_EQ(messageOf([]() -> Result<std::string> { std::abort(); }),
            "reading a.step: OpenCASCADE crashed (abort)");
  EXPECT_EQ(messageOf([]() -> Result<std::string> { ::_exit(0); }),
            "reading a.step: OpenCASCADE ended the process");
}

TEST(Guard, ParentHandlersStayOut) {
  const auto previous = std::signal(SIGSEGV, [](int) { ::_exit(7); });
  EXPECT_EQ(messageOf([]() -> Result<std::string> {
              ::raise(SIGSEGV);
              return "";
            }),
            "reading a.step: OpenCASCADE crashed (segmentation fault)");
  std::signal(SIGSEGV, previous);
}

TEST(Guard, EndlessRecursionEndsQuickly) {
  std::string message;
  const double seconds = secondsOf([&] {
    message = messageOf([]() -> Result<std::string> {
      volatile int depth = 0;
      return std::to_string(recurse(&depth));
    });
  });
  EXPECT_EQ(message, "reading a.step: OpenCASCADE crashed (segmentation fault)");
  EXPECT_LT(seconds, 5);  // the stack's pages are touched once: tenths of a second
}

TEST(Guard, TimeLimitHolds) {
  std::string message;
  const double seconds = secondsOf([&] {
    message = messageOf(
        []() -> Result<std::string> {
          volatile bool busy = true;
          while (busy) {
          }
          return "";
        },
        {.seconds = 0.3, .memoryMiB = 100});
  });
  EXPECT_EQ(message, "reading a.step did not finish within 0.3 s");
  EXPECT_GE(seconds, 0.3);
  EXPECT_LT(seconds, 5);  // a busy machine may delay the kill
}

TEST(Guard, WhatIsNotNeededEnds) {
  std::atomic<bool> cancelled = false;
  std::thread other([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    cancelled = true;
  });
  const auto forever = []() -> Result<std::string> {
    for (;;) ::pause();
  };
  {
    const CancelScope scope(cancelled);
    const Result<std::string> result = runInChild("waiting", kShort, forever);
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error().code, ErrorCode::Cancelled);
    EXPECT_FALSE(runInChild("again", kShort, [] { return Result<std::string>("bytes"); }));
  }
  EXPECT_TRUE(runInChild("again", kShort, [] { return Result<std::string>("bytes"); }));
  other.join();
}

TEST(Guard, MemoryLimitHolds) {
  const GuardLimits limits{.seconds = 20, .memoryMiB = 64};
  const auto allocate = [](std::size_t mib) {
    return [mib]() -> Result<std::string> {
      return std::to_string(std::vector<double>(mib << 17, 1.0).back());
    };
  };
  EXPECT_TRUE(runInChild("test", limits, allocate(32)));
  const auto result = runInChild("test", limits, allocate(200));
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, ErrorCode::ResourceLimit);
  EXPECT_EQ(result.error().message, "test needs more than 64 MiB of memory");
}

TEST(Guard, ChildIsSilent) {
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  EXPECT_TRUE(runInChild("test", kShort, []() -> Result<std::string> {
    std::cout << "loud" << std::endl;
    std::cerr << "louder" << std::endl;
    Message::SendFail("loudest");
    return "";
  }));
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST(Guard, LeavesNothingBehind) {
  const int before = openDescriptors();
  for (int i = 0; i < 20; ++i) {
    (void)runInChild("test", kShort, []() -> Result<std::string> { std::abort(); });
    (void)runInChild("test", kShort, []() -> Result<std::string> { return ""; });
  }
  EXPECT_EQ(openDescriptors(), before);
  EXPECT_EQ(::waitpid(-1, nullptr, WNOHANG), -1);
  EXPECT_EQ(errno, ECHILD);
}

TEST(Guard, ThreadsGuardAtOnce) {
  std::vector<std::string> answers(8);
  std::vector<std::thread> threads;
  for (std::size_t t = 0; t < answers.size(); ++t) {
    threads.emplace_back([&, t] {
      for (int i = 0; i < 10; ++i) {
        const auto result = runInChild("test", kShort, [&]() -> Result<std::string> {
          if (t % 2) ::raise(SIGSEGV);
          return std::string(100'000, static_cast<char>('a' + t));
        });
        answers[t] += result ? result->substr(0, 1) : "!";
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (std::size_t t = 0; t < answers.size(); ++t) {
    EXPECT_EQ(answers[t], std::string(10, t % 2 ? '!' : static_cast<char>('a' + t)));
  }
}

TEST(Guard, CostsLittle) {
  std::vector<char> ballast(std::size_t{512} << 20, 1);  // a parent with much memory in use
  const int runs = 20;
  const double seconds = secondsOf([&] {
    for (int i = 0; i < runs; ++i) {
      ASSERT_TRUE(runInChild("test", kShort, []() -> Result<std::string> { return ""; }));
    }
  });
  RecordProperty("milliseconds", std::to_string(1000 * seconds / runs));
  EXPECT_LT(seconds / runs, 0.2);  // measured: a few ms; room for a loaded machine
  EXPECT_EQ(ballast.back(), 1);
}

TEST(Guard, RefusesNonsenseLimits) {
  const auto result =
      runInChild("test", {.seconds = 0}, []() -> Result<std::string> { return ""; });
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, ErrorCode::InvalidArgument);
}

TEST(GuardOcct, CatchesInProcess) {
  const auto result =
      guardOcct("cutting", []() -> Result<int> { throw Standard_DomainError("x"); });
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().message, "cutting: OpenCASCADE failed (Standard_DomainError: x)");
}

TopoDS_Shape partWithLocations() {
  gp_Trsf turn;
  turn.SetRotation(gp_Ax1(gp_Pnt(0.1, 0.2, 0.3), gp_Dir(1, 2, 3)), 0.7);
  const TopoDS_Shape box = BRepPrimAPI_MakeBox(1.0 / 3, 2.0 / 7, 0.1).Shape();
  const TopoDS_Shape torus = BRepPrimAPI_MakeTorus(0.5, 0.1).Shape();
  return BRepAlgoAPI_Fuse(box, torus.Moved(TopLoc_Location(turn))).Shape();
}

TEST(ShapeBytes, KeepsEveryBitOfVertices) {
  const TopoDS_Shape shape = partWithLocations();
  const auto again = shapeOfBytes(bytesOfShape(shape));
  ASSERT_TRUE(again);
  TopTools_IndexedMapOfShape before;
  TopTools_IndexedMapOfShape after;
  TopExp::MapShapes(shape, before);
  TopExp::MapShapes(*again, after);
  ASSERT_EQ(after.Extent(), before.Extent());
  ASSERT_GT(before.Extent(), 20);
  for (int i = 1; i <= before.Extent(); ++i) {
    ASSERT_EQ(before(i).ShapeType(), after(i).ShapeType());
    EXPECT_EQ(before(i).Orientation(), after(i).Orientation());
    if (before(i).ShapeType() != TopAbs_VERTEX) continue;
    const gp_Pnt p = BRep_Tool::Pnt(TopoDS::Vertex(before(i)));
    const gp_Pnt q = BRep_Tool::Pnt(TopoDS::Vertex(after(i)));
    EXPECT_TRUE(p.X() == q.X() && p.Y() == q.Y() && p.Z() == q.Z()) << i;
    EXPECT_EQ(BRep_Tool::Tolerance(TopoDS::Vertex(before(i))),
              BRep_Tool::Tolerance(TopoDS::Vertex(after(i))));
  }
}

TEST(ShapeBytes, KeepsLocations) {
  gp_Trsf turn;
  turn.SetRotation(gp_Ax1(gp_Pnt(0.1, 0.2, 0.3), gp_Dir(1, 2, 3)), 0.7);
  const TopoDS_Shape box = BRepPrimAPI_MakeBox(1, 2, 3).Shape().Moved(TopLoc_Location(turn));
  const auto again = shapeOfBytes(bytesOfShape(box));
  ASSERT_TRUE(again);
  const gp_Trsf back = again->Location().Transformation();
  for (int row = 1; row <= 3; ++row) {
    for (int column = 1; column <= 4; ++column) {
      // gp_Trsf::SetValues normalises: one last bit may move.
      EXPECT_NEAR(back.Value(row, column), turn.Value(row, column), 1e-15);
    }
  }
}

TEST(ShapeBytes, RefusesDamage) {
  const std::string bytes = bytesOfShape(BRepPrimAPI_MakeBox(1, 2, 3).Shape());
  EXPECT_FALSE(shapeOfBytes(""));
  EXPECT_FALSE(shapeOfBytes("nonsense"));
  // Cut short, OpenCASCADE may do anything: a child tries.
  const auto result = runInChild("test", kShort, [&]() -> Result<std::string> {
    const auto shape = shapeOfBytes(std::string_view(bytes).substr(0, bytes.size() / 2));
    return shape ? "shape" : "error";
  });
  EXPECT_TRUE(!result || *result == "error");
}

/// Steps 0 to 5 that append their number; in `bad` something else happens.
std::string stepsWith(std::int64_t bad, const std::function<void()>& happens) {
  const auto result = runInChild("steps", {60, 1000}, [&]() -> Result<std::string> {
    std::string done;
    HangFence fence(0.3);
    for (std::int64_t step = 0; step < 6; ++step) {
      if (!fence.enter()) continue;
      if (step == bad) happens();
      done += static_cast<char>('0' + step);
    }
    return done;
  });
  return result ? *result : result.error().message;
}

TEST(HangFence, LeavesOutAStepThatHangsOrCrashes) {
  EXPECT_EQ(stepsWith(-1, {}), "012345");
  EXPECT_EQ(stepsWith(4,
                      [] {
                        for (volatile bool ever = true; ever;) {
                        }
                      }),
            "01235");
  EXPECT_EQ(stepsWith(0, [] { std::raise(SIGSEGV); }), "12345");
}

TEST(HangFence, GoesOnAfterManySuchSteps) {
  const auto result = runInChild("steps", {60, 1000}, []() -> Result<std::string> {
    int done = 0;
    HangFence fence(0.2);
    for (int step = 0; step < 12; ++step) {
      if (!fence.enter()) continue;
      if (step % 3 == 1) std::abort();
      ++done;
    }
    return std::to_string(done);
  });
  ASSERT_TRUE(result) << result.error().message;
  EXPECT_EQ(*result, "8");
}

TEST(HangFence, WhatComesAfterTheLastStepIsNotFenced) {
  const auto result = runInChild("steps", {60, 1000}, []() -> Result<std::string> {
    {
      HangFence fence(0.2);
      if (!fence.enter()) return std::string("left out");
    }
    std::raise(SIGSEGV);
    return std::string("survived");
  });
  ASSERT_FALSE(result);
  EXPECT_NE(result.error().message.find("segmentation fault"), std::string::npos)
      << result.error().message;
}

TEST(HangFence, OutsideOfAChildEveryStepIsEntered) {
  HangFence fence(1e-9);
  for (int step = 0; step < 3; ++step) EXPECT_TRUE(fence.enter());
}

}  // namespace
}  // namespace phront::cad
