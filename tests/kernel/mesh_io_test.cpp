// Meshes and fields through files: what is written reads back, and no file makes the reader crash.
#include "phront/mesh_io.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <limits>
#include <random>
#include <sstream>

#ifdef PHRONT_TEST_VTK
#include <vtkCell.h>
#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLUnstructuredGridReader.h>
#endif

namespace phront {
namespace {

namespace fs = std::filesystem;

/// A folder of its own for each test, removed afterwards.
class MeshIo : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = (fs::temp_directory_path() / "phront_mesh_io_XXXXXX").string();
    ASSERT_NE(mkdtemp(pattern.data()), nullptr);
    folder_ = pattern;
  }
  void TearDown() override { fs::remove_all(folder_); }

  [[nodiscard]] fs::path file(const std::string& name) const { return folder_ / name; }

  fs::path put(const std::string& name, const std::string& bytes) const {
    std::ofstream out(file(name), std::ios::binary);
    out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    return file(name);
  }

  [[nodiscard]] std::string get(const std::string& name) const {
    std::ifstream in(file(name), std::ios::binary);
    std::ostringstream all;
    all << in.rdbuf();
    return all.str();
  }

  [[nodiscard]] Result<TriMesh> read(const std::string& name, const std::string& bytes) const {
    return readMesh(put(name, bytes));
  }

  fs::path folder_;
};

/// Box with six labelled faces. Coordinates are no round numbers, so that lost bits show.
TriMesh box() {
  const Vec3 a(-0.1, -1.0 / 3, -std::sqrt(2.0));
  const Vec3 b(1.1, 2.0 / 3, std::sqrt(3.0));
  TriMesh mesh;
  for (int i = 0; i < 8; ++i) {
    mesh.points.emplace_back((i & 1 ? b : a).x(), (i & 2 ? b : a).y(), (i & 4 ? b : a).z());
  }
  const std::array<std::array<Index, 4>, 6> quads{
      {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}};
  for (std::size_t f = 0; f < quads.size(); ++f) {
    const auto& q = quads[f];
    mesh.triangles.push_back({q[0], q[1], q[2]});
    mesh.triangles.push_back({q[0], q[2], q[3]});
    mesh.faceOf.insert(mesh.faceOf.end(), 2, static_cast<Index>(f));
  }
  return mesh;
}
const double kBoxVolume = 1.2 * 1.0 * (std::sqrt(2.0) + std::sqrt(3.0));

bool sameBits(const TriMesh& a, const TriMesh& b) {
  return a.points.size() == b.points.size() && a.triangles == b.triangles &&
         std::equal(a.points.begin(), a.points.end(), b.points.begin());
}

template <class T>
std::string bytesOf(T value, std::endian order = std::endian::little) {
  std::string bytes(sizeof(T), '\0');
  std::memcpy(bytes.data(), &value, sizeof(T));
  if (order != std::endian::native) std::reverse(bytes.begin(), bytes.end());
  return bytes;
}

std::string binaryStl(std::uint32_t named, const std::vector<std::array<float, 9>>& facets,
                      const std::string& title = "") {
  std::string bytes = title;
  bytes.resize(80, ' ');
  bytes += bytesOf(named);
  for (const auto& facet : facets) {
    bytes += std::string(12, '\0');
    for (const float value : facet) bytes += bytesOf(value);
    bytes += std::string(2, '\0');
  }
  return bytes;
}
const std::vector<std::array<float, 9>> kTetrahedron{{0, 0, 0, 0, 1, 0, 1, 0, 0},
                                                     {0, 0, 0, 1, 0, 0, 0, 0, 1},
                                                     {0, 0, 0, 0, 0, 1, 0, 1, 0},
                                                     {1, 0, 0, 0, 1, 0, 0, 0, 1}};

void expectUnreadable(const Result<TriMesh>& result, const std::string& word) {
  ASSERT_FALSE(result.has_value()) << "expected a failure that says \"" << word << "\"";
  EXPECT_EQ(result.error().code, ErrorCode::UnreadableInput) << result.error().message;
  EXPECT_NE(result.error().message.find(word), std::string::npos) << result.error().message;
}

TEST_F(MeshIo, FormatFollowsExtensionInAnyCase) {
  EXPECT_EQ(meshFormatOf("a/b.StL"), MeshFormat::Stl);
  EXPECT_EQ(meshFormatOf("b.OBJ"), MeshFormat::Obj);
  EXPECT_EQ(meshFormatOf("b.ply"), MeshFormat::Ply);
  EXPECT_EQ(meshFormatOf("b.vtu"), MeshFormat::Vtu);
  const auto unknown = meshFormatOf("part.xyz");
  ASSERT_FALSE(unknown);
  EXPECT_EQ(unknown.error().code, ErrorCode::InvalidArgument);
  EXPECT_NE(unknown.error().message.find(".stl .obj .ply .vtu"), std::string::npos);
  EXPECT_FALSE(meshFormatOf("noextension"));
}

TEST_F(MeshIo, ObjAndPlyKeepEveryBitAndTheFaces) {
  const TriMesh mesh = box();
  for (const char* name : {"box.obj", "box.ply"}) {
    ASSERT_TRUE(writeMesh(mesh, file(name))) << name;
    const auto back = readMesh(file(name));
    ASSERT_TRUE(back) << back.error().message;
    EXPECT_TRUE(sameBits(*back, mesh)) << name;
    EXPECT_EQ(back->faceOf, mesh.faceOf) << name;
  }
}

TEST_F(MeshIo, StlKeepsTheClosedSolidInSinglePrecision) {
  const TriMesh mesh = box();
  ASSERT_TRUE(writeMesh(mesh, file("box.stl")));
  EXPECT_EQ(fs::file_size(file("box.stl")), 84U + 50U * 12U);
  const auto back = readMesh(file("box.stl"));
  ASSERT_TRUE(back) << back.error().message;
  EXPECT_EQ(back->points.size(), 8U);
  EXPECT_EQ(back->triangles.size(), 12U);
  EXPECT_TRUE(diagnose(*back).closedManifold());
  // Single precision: 6e-8 relative per coordinate.
  EXPECT_NEAR(signedVolume(*back), kBoxVolume, 1e-6);
}

TEST_F(MeshIo, StlSaysWhenACoordinateDoesNotFit) {
  TriMesh mesh = box();
  mesh.points[0].x() = 1e300;
  const auto done = writeMesh(mesh, file("far.stl"));
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().code, ErrorCode::CannotWrite);
  EXPECT_FALSE(fs::exists(file("far.stl")));
  EXPECT_TRUE(writeMesh(mesh, file("far.ply")));
}

TEST_F(MeshIo, BinaryStlMayStartWithSolid) {
  const auto mesh = read("solid.stl", binaryStl(4, kTetrahedron, "solid of a careless program"));
  ASSERT_TRUE(mesh) << mesh.error().message;
  EXPECT_NEAR(signedVolume(*mesh), 1.0 / 6, 1e-15);
  EXPECT_EQ(mesh->points.size(), 4U);
  // Trailing bytes, as some programs leave them, do not harm either.
  const auto longer = read("tail.stl", binaryStl(4, kTetrahedron) + "tail");
  ASSERT_TRUE(longer) << longer.error().message;
  EXPECT_EQ(longer->triangles.size(), 4U);
}

TEST_F(MeshIo, NegativeZeroDoesNotTearAnStlSurface) {
  auto facets = kTetrahedron;
  facets[1][1] = -0.0F;
  const auto mesh = read("zero.stl", binaryStl(4, facets));
  ASSERT_TRUE(mesh) << mesh.error().message;
  EXPECT_TRUE(diagnose(*mesh).closedManifold());
}

std::string asciiFacet(const std::string& a, const std::string& b, const std::string& c,
                       const std::string& eol) {
  return "  facet normal 0 0 nan" + eol + "    outer loop" + eol + "      vertex " + a + eol +
         "      vertex " + b + eol + "      VERTEX " + c + eol + "    endloop" + eol +
         "  endfacet" + eol;
}

TEST_F(MeshIo, AsciiStlSolidsBecomeFacesWithEitherLineEnd) {
  for (const std::string eol : {"\n", "\r\n"}) {
    const std::string text = "solid one two" + eol + asciiFacet("0 0 0", "0 1 0", "+1e0 0 0", eol) +
                             asciiFacet("0 0 0", "1 0 0", "0 0 1", eol) + "endsolid one two" + eol +
                             "solid" + eol + asciiFacet("0 0 0", "0 0 1", "0 1 0", eol) +
                             asciiFacet("1 0 0", "0 1 0", "0 0 1.0", eol) + "endsolid" + eol;
    const auto mesh = read("ascii.stl", text);
    ASSERT_TRUE(mesh) << mesh.error().message;
    EXPECT_TRUE(diagnose(*mesh).closedManifold());
    EXPECT_NEAR(signedVolume(*mesh), 1.0 / 6, 1e-15);
    EXPECT_EQ(mesh->faceOf, (std::vector<Index>{0, 0, 1, 1}));
  }
}

TEST_F(MeshIo, HostileStlIsRefused) {
  expectUnreadable(read("a.stl", ""), "empty");
  expectUnreadable(read("a.stl", "x"), "cut short");
  expectUnreadable(read("a.stl", binaryStl(0, {})), "no triangles");
  expectUnreadable(read("a.stl", binaryStl(0xffffffffU, kTetrahedron)), "cut short");
  expectUnreadable(read("a.stl", binaryStl(5, kTetrahedron)), "cut short");
  auto facets = kTetrahedron;
  facets[2][4] = std::numeric_limits<float>::quiet_NaN();
  expectUnreadable(read("a.stl", binaryStl(4, facets)), "not finite");
  expectUnreadable(read("a.stl", binaryStl(1, {{1, 2, 3, 1, 2, 3, 1, 2, 3}})), "degenerate");
  const std::string good = "solid\n" + asciiFacet("0 0 0", "1 0 0", "0 1 0", "\n") + "endsolid\n";
  ASSERT_TRUE(read("good.stl", good));
  for (std::size_t length = 1; length + 10 < good.size(); ++length) {
    EXPECT_FALSE(read("cut.stl", good.substr(0, length))) << length;
  }
  expectUnreadable(read("a.stl", "solid\n" + asciiFacet("0 0 0", "1 0 0", "0 1 inf", "\n")), "inf");
  expectUnreadable(read("a.stl", "solid\n" + asciiFacet("0 0 0", "1 0 0", "0 1 1e999", "\n")),
                   "line 6");
}

TEST_F(MeshIo, ObjReadsPolygonsNegativeIndicesAndGroups) {
  const std::string text =
      "# a pyramid\r\nmtllib x.mtl\r\nv 0 0 0\r\nv 1 0 0\r\nv 1 1 0\r\nv 0 1 0\r\nvn 0 0 1\r\n"
      "v 0.5 0.5 1 0.2 0.3 0.4\r\ng empty\r\ng base\r\nf 1/1/1 4//1 3/2 2\r\no sides\r\n"
      "usemtl red\r\nf -5 -4 -1\r\nf 2 3 \\\r\n 5\r\nf 3 4 5 # last but one\r\ng base\r\n"
      "f 4 1 5";
  const auto mesh = read("pyramid.obj", text);
  ASSERT_TRUE(mesh) << mesh.error().message;
  EXPECT_EQ(mesh->points.size(), 5U);
  EXPECT_EQ(mesh->triangles.size(), 6U);
  EXPECT_TRUE(diagnose(*mesh).closedManifold());
  EXPECT_NEAR(signedVolume(*mesh), 1.0 / 3, 1e-15);
  EXPECT_EQ(mesh->faceOf, (std::vector<Index>{0, 0, 1, 1, 1, 0}));
}

TEST_F(MeshIo, HostileObjIsRefused) {
  const std::string points = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  ASSERT_TRUE(read("good.obj", points + "f 1 2 3\n"));
  expectUnreadable(read("a.obj", points), "no faces");
  expectUnreadable(read("a.obj", points + "f 1 2 4\n"), "line 4");
  expectUnreadable(read("a.obj", points + "f 0 1 2\n"), "names point");
  expectUnreadable(read("a.obj", points + "f -4 1 2\n"), "names point");
  expectUnreadable(read("a.obj", points + "f 1 2 99999999999999999999\n"), "names point");
  expectUnreadable(read("a.obj", points + "f 1 2 x"), "line 4");
  expectUnreadable(read("a.obj", points + "f 1 2\n"), "2 corners");
  expectUnreadable(read("a.obj", "v 0 0\n"), "line 1");
  expectUnreadable(read("a.obj", "v 0 0 nan\nf 1 1 1\n"), "finite");
  expectUnreadable(read("a.obj", std::string("\0\1\2\3\\", 5)), "no faces");
}

std::string plyHeader(const std::string& format, const std::string& vertexCount = "5",
                      const std::string& faceCount = "5", const std::string& countType = "uchar") {
  return "ply\r\nformat " + format + " 1.0\r\ncomment x\r\nelement vertex " + vertexCount +
         "\r\nproperty float x\r\nproperty uchar red\r\nproperty double y\r\nproperty short z\r\n"
         "element marker 2\r\nproperty list uchar float anything\r\nelement face " +
         faceCount + "\r\nproperty list " + countType +
         " uint vertex_index\r\nproperty int face\r\n"
         "end_header\r\n";
}

/// A square pyramid of height 1 with one quad, in binary of the given byte order.
std::string binaryPlyBody(std::endian order) {
  std::string bytes;
  const std::array<std::array<double, 3>, 5> points{
      {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.5, 0.5, 1}}};
  for (const auto& p : points) {
    bytes += bytesOf(static_cast<float>(p[0]), order) + "r" + bytesOf(p[1], order) +
             bytesOf(static_cast<std::int16_t>(p[2]), order);
  }
  bytes += std::string(1, '\1') + bytesOf(1.5F, order) + std::string(1, '\0');
  const std::vector<std::vector<std::uint32_t>> faces{
      {0, 3, 2, 1}, {0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}};
  for (std::size_t f = 0; f < faces.size(); ++f) {
    bytes.push_back(static_cast<char>(faces[f].size()));
    for (const std::uint32_t corner : faces[f]) bytes += bytesOf(corner, order);
    bytes += bytesOf(static_cast<std::int32_t>(10 * f), order);
  }
  return bytes;
}

TEST_F(MeshIo, PlyReadsEveryEncoding) {
  const std::string ascii =
      plyHeader("ascii") +
      "0 9 0 0\r\n1 9 0 0\r\n1 9 1 0\r\n0 9 1 0\r\n.5 9 .5 1\r\n1 1.5\r\n0\r\n"
      "4 0 3 2 1 0\r\n3 0 1 4 10\r\n3 1 2 4 20\r\n3 2 3 4 30\r\n3 3 0 4 40\r\n";
  const std::vector<std::string> files{
      ascii, plyHeader("binary_little_endian") + binaryPlyBody(std::endian::little),
      plyHeader("binary_big_endian") + binaryPlyBody(std::endian::big)};
  for (const std::string& bytes : files) {
    const auto mesh = read("pyramid.ply", bytes);
    ASSERT_TRUE(mesh) << mesh.error().message;
    EXPECT_EQ(mesh->points.size(), 5U);
    EXPECT_TRUE(diagnose(*mesh).closedManifold());
    EXPECT_NEAR(signedVolume(*mesh), 1.0 / 3, 1e-15);
    EXPECT_EQ(mesh->faceOf, (std::vector<Index>{0, 0, 10, 20, 30, 40}));
  }
}

TEST_F(MeshIo, HostilePlyIsRefused) {
  const std::string body = binaryPlyBody(std::endian::little);
  const std::string binary = "binary_little_endian";
  const std::string good = plyHeader(binary) + body;
  ASSERT_TRUE(read("good.ply", good));
  for (std::size_t length = 1; length < good.size(); ++length) {
    EXPECT_FALSE(read("cut.ply", good.substr(0, length))) << length;
  }
  expectUnreadable(read("a.ply", plyHeader(binary, "18446744073709551615") + body), "vertex");
  expectUnreadable(read("a.ply", plyHeader(binary, "5", "4000000000") + body), "face");
  expectUnreadable(read("a.ply", plyHeader(binary, "-5") + body), "element line");
  expectUnreadable(read("a.ply", plyHeader(binary, "5", "5", "float") + body), "whole number");
  // A list that claims four thousand million corners.
  std::string longList = good;
  longList.replace(longList.find("list uchar uint"), 15, "list uint uint");
  expectUnreadable(read("a.ply", longList), "face");
  std::string outside = good;
  outside[outside.size() - 8] = 5;  // last corner of the last face
  expectUnreadable(read("a.ply", outside), "names point 5");
  std::string notFinite = good;
  notFinite.replace(plyHeader(binary).size(), 4, bytesOf(std::nanf("")));
  expectUnreadable(read("a.ply", notFinite), "not finite");
  expectUnreadable(read("a.ply",
                        "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\n"
                        "property float y\nend_header\n0 0\n"),
                   "without z");
  expectUnreadable(read("a.ply", "plain text"), "start with");
  // No bytes per element: the count must not become a loop.
  expectUnreadable(read("a.ply", "ply\nformat ascii 1.0\nelement face 9999999999999\nend_header\n"),
                   "no faces");
}

TEST_F(MeshIo, RandomDamageNeverCrashes) {
  const TriMesh mesh = box();
  std::mt19937 random(20240607);  // NOLINT: the same damage every time
  int refused = 0;
  for (const std::string name : {"d.stl", "d.obj", "d.ply"}) {
    ASSERT_TRUE(writeMesh(mesh, file(name)));
    const std::string good = get(name);
    for (int round = 0; round < 300; ++round) {
      std::string bad = good;
      const auto hits = 1 + random() % 8;
      for (unsigned i = 0; i < hits; ++i) bad[random() % bad.size()] = static_cast<char>(random());
      if (random() % 4 == 0) bad.resize(random() % bad.size());
      const auto result = read(name, bad);
      if (!result) {
        ++refused;
        continue;
      }
      const MeshDiagnostics found = diagnose(*result);
      EXPECT_EQ(found.badIndices, 0);
      EXPECT_EQ(found.nonFinitePoints, 0);
      EXPECT_FALSE(result->triangles.empty());
    }
  }
  EXPECT_GT(refused, 100);
}

TEST_F(MeshIo, MissingFilesFoldersAndPipesAreRefusedWithoutWaiting) {
  expectUnreadable(readMesh(file("nowhere.stl")), "nowhere.stl");
  fs::create_directory(file("folder.stl"));
  expectUnreadable(readMesh(file("folder.stl")), "regular file");
  ASSERT_EQ(mkfifo(file("pipe.stl").c_str(), 0600), 0);
  expectUnreadable(readMesh(file("pipe.stl")), "regular file");
  const auto vtu = readMesh(put("mesh.vtu", "x"));
  ASSERT_FALSE(vtu);
  EXPECT_EQ(vtu.error().code, ErrorCode::NotSupported);
}

TEST_F(MeshIo, BadMeshIsNotWritten) {
  TriMesh mesh = box();
  mesh.triangles[3][1] = 8;
  const auto done = writeMesh(mesh, file("bad.ply"));
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().code, ErrorCode::InvalidArgument);
  EXPECT_FALSE(fs::exists(file("bad.ply")));
}

TEST_F(MeshIo, WritingReplacesWhollyAndLeavesNothingBehind) {
  ASSERT_TRUE(writeFileAtomically(file("a.txt"), "first, which is longer"));
  fs::permissions(file("a.txt"), fs::perms::owner_read | fs::perms::owner_write);
  fs::create_symlink("a.txt", file("link.txt"));
  ASSERT_TRUE(writeFileAtomically(file("link.txt"), "second"));
  EXPECT_EQ(get("a.txt"), "second");
  EXPECT_TRUE(fs::is_symlink(file("link.txt")));
  EXPECT_EQ(fs::status(file("a.txt")).permissions(),
            fs::perms::owner_read | fs::perms::owner_write);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()), 2);
}

TEST_F(MeshIo, WritingFailsCleanly) {
  for (const fs::path& target : {file("no/such/folder/a.stl"), folder_}) {
    const auto done = writeFileAtomically(target, "bytes");
    ASSERT_FALSE(done);
    EXPECT_EQ(done.error().code, ErrorCode::CannotWrite);
    EXPECT_NE(done.error().message.find(target.string()), std::string::npos);
  }
  EXPECT_TRUE(fs::is_empty(folder_));
}

TEST_F(MeshIo, DevicesAreWrittenToNotReplaced) {
  ASSERT_TRUE(writeFileAtomically("/dev/null", "gone"));
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
}

TEST_F(MeshIo, FieldsAreWrittenAsVtuOnly) {
  const auto done = writeField(DistanceField(), file("phi.stl"));
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().code, ErrorCode::InvalidArgument);
}

#ifdef PHRONT_TEST_VTK

TEST_F(MeshIo, VtkReadsTheMeshWithItsFaces) {
  const TriMesh mesh = box();
  ASSERT_TRUE(writeMesh(mesh, file("box.vtu")));
  vtkNew<vtkXMLUnstructuredGridReader> reader;
  reader->SetFileName(file("box.vtu").c_str());
  reader->Update();
  vtkUnstructuredGrid* grid = reader->GetOutput();
  ASSERT_EQ(grid->GetNumberOfPoints(), 8);
  ASSERT_EQ(grid->GetNumberOfCells(), 12);
  vtkDataArray* faces = grid->GetCellData()->GetArray("faceOf");
  ASSERT_NE(faces, nullptr);
  for (vtkIdType p = 0; p < 8; ++p) {
    const double* x = grid->GetPoint(p);
    EXPECT_EQ(Vec3(x[0], x[1], x[2]), mesh.points[static_cast<std::size_t>(p)]);
  }
  for (vtkIdType t = 0; t < 12; ++t) {
    const auto i = static_cast<std::size_t>(t);
    EXPECT_EQ(faces->GetTuple1(t), mesh.faceOf[i]);
    for (int k = 0; k < 3; ++k) {
      EXPECT_EQ(grid->GetCell(t)->GetPointId(k), mesh.triangles[i][static_cast<std::size_t>(k)]);
    }
  }
}

TEST_F(MeshIo, VtkReadsTheField) {
  const auto surface = SurfaceDistance::build(box());
  ASSERT_TRUE(surface);
  const double h = 0.2;
  const auto field =
      solveDistanceField(*surface, {.spacing = h, .bandMin = -0.3, .bandMax = 0.4, .threads = 1});
  ASSERT_TRUE(field) << field.error().message;
  ASSERT_TRUE(writeField(*field, file("phi.vtu")));

  vtkNew<vtkXMLUnstructuredGridReader> reader;
  reader->SetFileName(file("phi.vtu").c_str());
  reader->Update();
  vtkUnstructuredGrid* grid = reader->GetOutput();
  const auto nodes = static_cast<vtkIdType>(field->values().size());
  ASSERT_EQ(grid->GetNumberOfPoints(), nodes);  // closed surface: phi at every node
  ASSERT_GT(nodes, 0);
  vtkDataArray* phi = grid->GetPointData()->GetArray("phi");
  ASSERT_NE(phi, nullptr);
  ASSERT_NE(grid->GetPointData()->GetArray("triangle"), nullptr);
  for (vtkIdType p = 0; p < nodes; ++p) {
    const double* x = grid->GetPoint(p);
    // The field is exact up to round-off.
    ASSERT_NEAR(phi->GetTuple1(p), surface->signedDistance(Vec3(x[0], x[1], x[2])), 1e-12);
  }
  ASSERT_GT(grid->GetNumberOfCells(), nodes / 2);
  for (vtkIdType c = 0; c < grid->GetNumberOfCells(); ++c) {
    // Corners 0, 1, 3, 4 of a VTK hexahedron span it: the frame must be the grid's own.
    const auto corner = [&](int k) {
      const double* x = grid->GetPoint(grid->GetCell(c)->GetPointId(k));
      return Vec3(x[0], x[1], x[2]);
    };
    const Vec3 first = corner(0);
    ASSERT_NEAR((corner(1) - first - Vec3(h, 0, 0)).norm(), 0, 1e-12);
    ASSERT_NEAR((corner(3) - first - Vec3(0, h, 0)).norm(), 0, 1e-12);
    ASSERT_NEAR((corner(4) - first - Vec3(0, 0, h)).norm(), 0, 1e-12);
    ASSERT_NEAR((corner(6) - first - Vec3(h, h, h)).norm(), 0, 1e-12);
  }
}

#endif

}  // namespace
}  // namespace phront
