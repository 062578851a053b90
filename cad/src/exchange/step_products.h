// The tree of products in a STEP file: assemblies as nested compounds, and what they are called.
#pragma once

#include <STEPControl_Writer.hxx>
#include <TopoDS_Shape.hxx>
#include <string>
#include <vector>

#include "phront/cad/shape.h"

namespace phront::cad {

struct ProductTree {
  struct Product {
    TopoDS_Shape shape;
    std::string name;
  };
  std::vector<TopoDS_Shape> roots;  ///< each for one transfer, in the order of the bodies
  std::vector<Product> products;    ///< assemblies and bodies
};

/// Assemblies without bodies are left out.
[[nodiscard]] ProductTree productTree(const Model& model);

/// After the roots were transferred.
void nameProducts(const STEPControl_Writer& writer, const ProductTree& tree);

}  // namespace phront::cad
