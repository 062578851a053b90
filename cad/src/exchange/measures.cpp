#include "exchange/measures.h"

#include <BRepGProp.hxx>
#include <GProp_GProps.hxx>
#include <cmath>

namespace phront::cad {

double areaOf(const TopoDS_Shape& shape) {
  GProp_GProps properties;
  BRepGProp::SurfaceProperties(shape, properties);
  return std::abs(properties.Mass());
}

double accurateAreaOf(const TopoDS_Shape& shape) {
  constexpr double kAccuracy = 1e-5;
  GProp_GProps properties;
  BRepGProp::SurfaceProperties(shape, properties, kAccuracy);
  return std::abs(properties.Mass());
}

double volumeOf(const TopoDS_Shape& shape) {
  GProp_GProps properties;
  BRepGProp::VolumeProperties(shape, properties);
  return properties.Mass();
}

}  // namespace phront::cad
