// Pieces of a VTU file: VTK's XML format for unstructured grids.
#pragma once

#include <fmt/format.h>

#include <bit>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

namespace phront::io {

/// Collects the arrays of one piece: XML lines that name offsets, and the bytes behind them.
class VtuPiece {
 public:
  template <class T>
  std::string add(std::string_view name, std::string_view type, int components,
                  const std::vector<T>& values) {
    static_assert(std::endian::native == std::endian::little, "VTU is written as little endian");
    std::string line = fmt::format(
        "        <DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"appended\" "
        "offset=\"{}\"/>\n",
        type, name, components, data_.size());
    const std::uint64_t size = values.size() * sizeof(T);
    const std::size_t begin = data_.size();
    data_.resize(begin + sizeof size + size);
    std::memcpy(data_.data() + begin, &size, sizeof size);
    if (size > 0) std::memcpy(data_.data() + begin + sizeof size, values.data(), size);
    return line;
  }

  [[nodiscard]] const std::string& data() const { return data_; }

 private:
  std::string data_;
};

/// Cells of one kind.
struct Cells {
  std::vector<std::int32_t> connectivity;
  std::uint8_t type = 0;  ///< VTK's number of the cell type
  std::size_t corners = 0;
};

/// The whole file. `pointData` and `cellData` are lines that add() returned.
[[nodiscard]] std::string assembleVtu(VtuPiece& piece, const std::vector<double>& coordinates,
                                      const Cells& cells, const std::string& pointData,
                                      const std::string& cellData);

}  // namespace phront::io
