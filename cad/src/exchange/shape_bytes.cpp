// OpenCASCADE's binary shape format on a string. Reals are written as their eight bytes, so
// geometry, parameters and tolerances arrive bit for bit; a rotated location may differ in its last
// bit, as gp_Trsf normalises the matrix it is given.
#include "exchange/shape_bytes.h"

#include <BinTools.hxx>
#include <istream>
#include <sstream>
#include <streambuf>

#include "exchange/guard.h"

namespace phront::cad {
namespace {

// Reads straight from the bytes, without the copy an istringstream makes.
class ViewBuffer : public std::streambuf {
 public:
  explicit ViewBuffer(std::string_view bytes) {
    char* begin = const_cast<char*>(bytes.data());
    setg(begin, begin, begin + bytes.size());
  }

 protected:
  pos_type seekoff(off_type offset, std::ios_base::seekdir from, std::ios_base::openmode) override {
    const off_type size = egptr() - eback();
    const off_type base = from == std::ios_base::beg   ? 0
                          : from == std::ios_base::cur ? gptr() - eback()
                                                       : size;
    const off_type to = base + offset;
    if (to < 0 || to > size) return pos_type(off_type(-1));
    setg(eback(), eback() + to, egptr());
    return pos_type(to);
  }
  pos_type seekpos(pos_type position, std::ios_base::openmode which) override {
    return seekoff(off_type(position), std::ios_base::beg, which);
  }
};

}  // namespace

std::string bytesOfShape(const TopoDS_Shape& shape) {
  std::ostringstream stream(std::ios::binary);
  BinTools::Write(shape, stream, Standard_False, Standard_False, BinTools_FormatVersion_CURRENT);
  return std::move(stream).str();
}

Result<TopoDS_Shape> shapeOfBytes(std::string_view bytes) {
  // Else BinTools says so on stdout.
  if (bytes.substr(0, 64).find("Open CASCADE Topology") == std::string_view::npos) {
    return fail(ErrorCode::Failed, "reading a shape from memory: these bytes are no shape");
  }
  return guardOcct("reading a shape from memory", [&]() -> Result<TopoDS_Shape> {
    ViewBuffer buffer(bytes);
    std::istream stream(&buffer);
    TopoDS_Shape shape;
    BinTools::Read(shape, stream);
    if (shape.IsNull()) {
      return fail(ErrorCode::Failed, "reading a shape from memory gave no shape");
    }
    return shape;
  });
}

}  // namespace phront::cad
