// The platform "surfaceless" of Mesa needs neither /dev/dri nor X: with libgl1-mesa-dri it falls
// back to software rendering. Without that platform EGL's default display is tried.
#include "io/draw/egl_context.h"

#include <EGL/eglext.h>
#include <fmt/format.h>

#include <array>
#include <cstring>
#include <utility>

namespace phront::io {
namespace {

EGLDisplay openDisplay() {
  const char* extensions = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
  if (extensions != nullptr &&
      std::strstr(extensions, "EGL_MESA_platform_surfaceless") != nullptr) {
    const auto getPlatformDisplay = reinterpret_cast<PFNEGLGETPLATFORMDISPLAYEXTPROC>(
        eglGetProcAddress("eglGetPlatformDisplayEXT"));
    if (getPlatformDisplay != nullptr) {
      const EGLDisplay display =
          getPlatformDisplay(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
      if (display != EGL_NO_DISPLAY && eglInitialize(display, nullptr, nullptr) == EGL_TRUE) {
        return display;
      }
    }
  }
  const EGLDisplay display = eglGetDisplay(EGL_DEFAULT_DISPLAY);
  if (display != EGL_NO_DISPLAY && eglInitialize(display, nullptr, nullptr) == EGL_TRUE) {
    return display;
  }
  return EGL_NO_DISPLAY;
}

tl::unexpected<Error> noGl(std::string_view what) {
  return fail(ErrorCode::NotSupported,
              fmt::format("no picture: {} (EGL error {:#x}); install libegl1 and libgl1-mesa-dri",
                          what, eglGetError()));
}

}  // namespace

Result<EglContext> EglContext::create() {
  EglContext made;
  made.display_ = openDisplay();
  if (made.display_ == EGL_NO_DISPLAY) return noGl("EGL has no display that works without X");
  if (eglBindAPI(EGL_OPENGL_API) != EGL_TRUE) return noGl("EGL has no desktop OpenGL");

  constexpr std::array<EGLint, 5> kConfig{EGL_SURFACE_TYPE, EGL_DONT_CARE, EGL_RENDERABLE_TYPE,
                                          EGL_OPENGL_BIT, EGL_NONE};
  EGLConfig config = nullptr;
  EGLint count = 0;
  if (eglChooseConfig(made.display_, kConfig.data(), &config, 1, &count) != EGL_TRUE || count < 1) {
    return noGl("EGL has no configuration with OpenGL");
  }
  // VTK's shaders ask for 3.2.
  constexpr std::array<EGLint, 7> kContext{EGL_CONTEXT_MAJOR_VERSION,
                                           3,
                                           EGL_CONTEXT_MINOR_VERSION,
                                           2,
                                           EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                           EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                           EGL_NONE};
  made.context_ = eglCreateContext(made.display_, config, EGL_NO_CONTEXT, kContext.data());
  if (made.context_ == EGL_NO_CONTEXT) return noGl("EGL makes no OpenGL 3.2 context");
  if (!made.makeCurrent()) return noGl("EGL cannot use a context without surface");
  return made;
}

EglContext::EglContext(EglContext&& other) noexcept
    : display_(std::exchange(other.display_, EGL_NO_DISPLAY)),
      context_(std::exchange(other.context_, EGL_NO_CONTEXT)) {}

EglContext::~EglContext() {
  if (display_ == EGL_NO_DISPLAY) return;
  if (context_ != EGL_NO_CONTEXT) {
    eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    eglDestroyContext(display_, context_);
  }
  // The display stays initialised: others in this process may use the same one.
}

bool EglContext::makeCurrent() const {
  return eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_) == EGL_TRUE;
}

bool EglContext::isCurrent() const { return eglGetCurrentContext() == context_; }

}  // namespace phront::io
