// Colours of solids and faces in STEP files.
#pragma once

#include <XSControl_WorkSession.hxx>

#include "exchange/load_shapes.h"

namespace phront::cad {

/// Binds the colours of the file's styled items to the solids and faces they were read as.
void readColours(const Handle(XSControl_WorkSession) & session, ShapeMarks& marks);

/// Styles the solids and faces that the session has written.
void writeColours(const Handle(XSControl_WorkSession) & session, const Model& model);

}  // namespace phront::cad
