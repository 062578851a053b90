#include "face_wish.h"

#include <fmt/format.h>

#include <utility>

namespace phront::cli {

void addFaceWish(CLI::App& command, FaceWish& wish) {
  command
      .add_option("--distance-of", wish.terms,
                  "A face (as in --open) with a distance of its own, or a thickness of its wall; "
                  "may be given several times")
      ->option_text("FACE=D")
      ->take_all();
}

Result<std::vector<FaceLength>> resolve(const FaceWish& wish, const cad::Model& model,
                                        const CommonOptions& common) {
  std::vector<FaceLength> all;
  for (const std::string& term : wish.terms) {
    const std::size_t equals = term.rfind('=');  // names may hold one, too
    if (equals == std::string::npos)
      return fail(ErrorCode::InvalidArgument,
                  fmt::format("--distance-of '{}' gives no distance: write a face, =, and a "
                              "length, for example F3=2 or name:lid=0.1in",
                              term));
    const Result<std::vector<cad::FaceId>> faces = cad::selectFaces(model, term.substr(0, equals));
    if (!faces) return tl::unexpected(faces.error());
    const Result<double> length = parseLength(term.substr(equals + 1), common.unit);
    if (!length) return tl::unexpected(length.error());
    for (const cad::FaceId& face : *faces) all.push_back({face, *length});
  }
  return all;
}

Result<cad::Model> withFacesMoved(const FaceWish& wish, const cad::Model& model, double distance,
                                  const CommonOptions& common) {
  const Result<std::vector<FaceLength>> lengths = resolve(wish, model, common);
  if (!lengths) return tl::unexpected(lengths.error());
  std::vector<cad::FaceMove> moves;
  for (const FaceLength& own : *lengths) moves.push_back({own.face, own.length - distance});
  Result<cad::MovedModel> moved = cad::moveFaces(model, moves);
  if (!moved) return tl::unexpected(moved.error());
  return std::move(moved->model);
}

}  // namespace phront::cli
