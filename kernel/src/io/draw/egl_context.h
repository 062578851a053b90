// An OpenGL context without window, display or X server.
#pragma once

#include <EGL/egl.h>

#include "phront/status.h"

namespace phront::io {

/// Surfaceless EGL context with desktop OpenGL 3.2 or newer (software or hardware, as EGL finds
/// it).
class EglContext {
 public:
  /// Current in the calling thread on success. Fails with NotSupported.
  [[nodiscard]] static Result<EglContext> create();

  EglContext(EglContext&& other) noexcept;
  EglContext& operator=(EglContext&&) = delete;
  ~EglContext();

  [[nodiscard]] bool makeCurrent() const;
  [[nodiscard]] bool isCurrent() const;

 private:
  EglContext() = default;
  EGLDisplay display_ = EGL_NO_DISPLAY;
  EGLContext context_ = EGL_NO_CONTEXT;
};

}  // namespace phront::io
