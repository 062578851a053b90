// Fields in the order of the structs; strings and lists led by their length (8 bytes, host order:
// both ends are the same program).
#include "exchange/model_bytes.h"

#include <BRep_Builder.hxx>
#include <TopoDS_Compound.hxx>
#include <TopoDS_Iterator.hxx>
#include <cstdint>
#include <cstring>

#include "exchange/shape_bytes.h"
#include "phront/cad/shape_occt.h"

namespace phront::cad {
namespace {

class Writer {
 public:
  void number(std::uint64_t value) { raw(&value, sizeof value); }
  void index(int value) { number(static_cast<std::uint64_t>(value + 1)); }  // -1: none
  void real(double value) { raw(&value, sizeof value); }
  void text(std::string_view value) {
    number(value.size());
    raw(value.data(), value.size());
  }
  void texts(const std::vector<std::string>& values) {
    number(values.size());
    for (const std::string& value : values) text(value);
  }
  void colour(const std::optional<Colour>& value) {
    number(value ? 1 : 0);
    if (!value) return;
    real(value->red);
    real(value->green);
    real(value->blue);
  }
  [[nodiscard]] std::string take() { return std::move(bytes_); }

 private:
  void raw(const void* data, std::size_t size) {
    bytes_.append(static_cast<const char*>(data), size);
  }
  std::string bytes_;
};

class Reader {
 public:
  explicit Reader(std::string_view bytes) : bytes_(bytes) {}
  std::uint64_t number() {
    std::uint64_t value = 0;
    raw(&value, sizeof value);
    return value;
  }
  int index() { return static_cast<int>(number()) - 1; }
  double real() {
    double value = 0;
    raw(&value, sizeof value);
    return value;
  }
  std::string_view text() {
    const std::uint64_t size = number();
    if (size > bytes_.size()) {
      good_ = false;
      return {};
    }
    const std::string_view value = bytes_.substr(0, size);
    bytes_.remove_prefix(size);
    return value;
  }
  std::vector<std::string> texts() {
    std::vector<std::string> values;
    for (std::uint64_t n = number(); n > 0 && good_; --n) values.emplace_back(text());
    return values;
  }
  std::optional<Colour> colour() {
    if (number() == 0) return std::nullopt;
    Colour value;
    value.red = real();
    value.green = real();
    value.blue = real();
    return value;
  }
  [[nodiscard]] bool good() const { return good_; }

 private:
  void raw(void* data, std::size_t size) {
    if (size > bytes_.size()) {
      good_ = false;
      return;
    }
    std::memcpy(data, bytes_.data(), size);
    bytes_.remove_prefix(size);
  }
  std::string_view bytes_;
  bool good_ = true;
};

}  // namespace

std::string bytesOfModel(const Model& model) {
  Writer writer;
  writer.text(model.unit);
  writer.real(model.unitInMm);
  writer.texts(model.warnings);
  writer.number(model.assemblies.size());
  for (const AssemblyNode& assembly : model.assemblies) {
    writer.text(assembly.name);
    writer.index(assembly.parent);
  }
  writer.number(model.bodies.size());
  // All in one compound, so that what bodies share stays shared: instances of one part.
  const BRep_Builder builder;
  TopoDS_Compound all;
  builder.MakeCompound(all);
  for (const Body& body : model.bodies) {
    writer.number(body.kind == BodyKind::Solid ? 0 : 1);
    writer.number(body.valid ? 1 : 0);
    writer.text(body.name);
    writer.index(body.assembly);
    writer.texts(body.faceNames);
    writer.colour(body.colour);
    writer.number(body.faceColours.size());
    for (const std::optional<Colour>& colour : body.faceColours) writer.colour(colour);
    writer.number(body.shape.empty() ? 0 : 1);
    if (!body.shape.empty()) builder.Add(all, occtShape(body.shape));
  }
  writer.text(bytesOfShape(all));
  return writer.take();
}

Result<Model> modelOfBytes(std::string_view bytes) {
  Reader reader(bytes);
  Model model;
  model.unit = reader.text();
  model.unitInMm = reader.real();
  model.warnings = reader.texts();
  for (std::uint64_t n = reader.number(); n > 0 && reader.good(); --n) {
    AssemblyNode assembly;
    assembly.name = reader.text();
    assembly.parent = reader.index();
    model.assemblies.push_back(std::move(assembly));
  }
  std::vector<bool> hasShape;
  for (std::uint64_t n = reader.number(); n > 0 && reader.good(); --n) {
    Body body;
    body.kind = reader.number() == 0 ? BodyKind::Solid : BodyKind::Sheet;
    body.valid = reader.number() != 0;
    body.name = reader.text();
    body.assembly = reader.index();
    body.faceNames = reader.texts();
    body.colour = reader.colour();
    for (std::uint64_t c = reader.number(); c > 0 && reader.good(); --c)
      body.faceColours.push_back(reader.colour());
    hasShape.push_back(reader.number() != 0);
    model.bodies.push_back(std::move(body));
  }
  const std::string_view shapeBytes = reader.text();
  if (!reader.good()) return fail(ErrorCode::Failed, "a model in memory is cut short");
  const auto all = shapeOfBytes(shapeBytes);
  if (!all) return tl::unexpected<Error>(all.error());
  TopoDS_Iterator shape(*all);
  for (std::size_t b = 0; b < model.bodies.size(); ++b) {
    if (!hasShape[b]) continue;
    if (!shape.More()) return fail(ErrorCode::Failed, "a model in memory lacks a body");
    model.bodies[b].shape = makeShape(shape.Value());
    shape.Next();
  }
  return model;
}

}  // namespace phront::cad
