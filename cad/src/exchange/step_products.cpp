#include "exchange/step_products.h"

#include <fmt/format.h>

#include <BRep_Builder.hxx>
#include <STEPConstruct_Part.hxx>
#include <StepShape_ShapeDefinitionRepresentation.hxx>
#include <TCollection_HAsciiString.hxx>
#include <TopoDS_Compound.hxx>
#include <TransferBRep.hxx>
#include <TransferBRep_ShapeMapper.hxx>
#include <Transfer_FinderProcess.hxx>
#include <XSControl_TransferWriter.hxx>
#include <XSControl_WorkSession.hxx>

#include "exchange/step_string.h"
#include "phront/cad/shape_occt.h"

namespace phront::cad {
namespace {

class TreeMaker {
 public:
  explicit TreeMaker(const Model& model) : model_(model), children_(model.assemblies.size()) {}

  ProductTree make() {
    for (const Body& body : model_.bodies) hang(occtShape(body.shape), body.assembly);
    for (std::size_t b = 0; b < model_.bodies.size(); ++b) {
      const Body& body = model_.bodies[b];
      tree_.products.push_back(
          {occtShape(body.shape), body.name.empty() ? fmt::format("body {}", b + 1) : body.name});
    }
    // Children come after their parents: from the last on, all that a compound holds is complete.
    std::vector<TopoDS_Compound> compounds(model_.assemblies.size());
    for (std::size_t a = compounds.size(); a-- > 0;) {
      if (children_[a].empty()) continue;
      BRep_Builder builder;
      builder.MakeCompound(compounds[a]);
      for (const Child& child : children_[a])
        builder.Add(compounds[a], child.assembly < 0
                                      ? child.shape
                                      : compounds[static_cast<std::size_t>(child.assembly)]);
      const std::string& name = model_.assemblies[a].name;
      tree_.products.push_back(
          {compounds[a], name.empty() ? fmt::format("assembly {}", a + 1) : name});
    }
    for (const Child& root : roots_)
      tree_.roots.push_back(root.assembly < 0 ? root.shape
                                              : compounds[static_cast<std::size_t>(root.assembly)]);
    return std::move(tree_);
  }

 private:
  struct Child {
    TopoDS_Shape shape;  ///< of a body
    int assembly = -1;   ///< or this
  };

  void hang(const TopoDS_Shape& shape, int assembly) {
    Child child{shape, -1};
    for (; assembly >= 0; assembly = model_.assemblies[static_cast<std::size_t>(assembly)].parent) {
      std::vector<Child>& siblings = children_[static_cast<std::size_t>(assembly)];
      const bool known = !siblings.empty();
      siblings.push_back(child);
      if (known) return;
      child = {{}, assembly};
    }
    roots_.push_back(child);
  }

  const Model& model_;
  std::vector<std::vector<Child>> children_;
  std::vector<Child> roots_;
  ProductTree tree_;
};

Handle(StepShape_ShapeDefinitionRepresentation)
    productOf(const Handle(Transfer_FinderProcess) & process, const TopoDS_Shape& shape) {
  Handle(StepShape_ShapeDefinitionRepresentation) definition;
  for (const TopoDS_Shape& key : {shape, shape.Located(TopLoc_Location())}) {
    const Handle(TransferBRep_ShapeMapper) mapper = TransferBRep::ShapeMapper(process, key);
    if (process->FindTypedTransient(mapper, STANDARD_TYPE(StepShape_ShapeDefinitionRepresentation),
                                    definition))
      break;
  }
  return definition;
}

}  // namespace

ProductTree productTree(const Model& model) { return TreeMaker(model).make(); }

void nameProducts(const STEPControl_Writer& writer, const ProductTree& tree) {
  const Handle(Transfer_FinderProcess) process = writer.WS()->TransferWriter()->FinderProcess();
  for (const ProductTree::Product& product : tree.products) {
    const auto definition = productOf(process, product.shape);
    if (definition.IsNull()) continue;
    STEPConstruct_Part part;
    part.ReadSDR(definition);
    const Handle(TCollection_HAsciiString) name =
        new TCollection_HAsciiString(stepString(product.name).c_str());
    part.SetPname(name);
    part.SetPid(name);
  }
}

}  // namespace phront::cad
