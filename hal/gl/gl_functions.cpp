// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "hal/gl/gl_functions.h"

namespace vitrine::hal {
namespace {

template <typename Function>
bool find(GetProc get_proc, const char* name, Function& function) {
  function = reinterpret_cast<Function>(get_proc(name));
  return function != nullptr;
}

}  // namespace

Status load_gl_functions(GetProc get_proc, GlFunctions& gl) {
  const bool complete =
      find(get_proc, "glGetError", gl.GetError) && find(get_proc, "glGetString", gl.GetString) &&
      find(get_proc, "glGetStringi", gl.GetStringi) && find(get_proc, "glGetIntegerv", gl.GetIntegerv) &&
      find(get_proc, "glEnable", gl.Enable) && find(get_proc, "glDisable", gl.Disable) &&
      find(get_proc, "glCullFace", gl.CullFace) && find(get_proc, "glDepthFunc", gl.DepthFunc) &&
      find(get_proc, "glDepthMask", gl.DepthMask) && find(get_proc, "glViewport", gl.Viewport) &&
      find(get_proc, "glClearColor", gl.ClearColor) && find(get_proc, "glClear", gl.Clear) &&
      find(get_proc, "glFinish", gl.Finish) && find(get_proc, "glGenTextures", gl.GenTextures) &&
      find(get_proc, "glDeleteTextures", gl.DeleteTextures) && find(get_proc, "glBindTexture", gl.BindTexture) &&
      find(get_proc, "glActiveTexture", gl.ActiveTexture) && find(get_proc, "glTexParameteri", gl.TexParameteri) &&
      find(get_proc, "glTexImage2D", gl.TexImage2D) && find(get_proc, "glTexSubImage2D", gl.TexSubImage2D) &&
      find(get_proc, "glGenBuffers", gl.GenBuffers) && find(get_proc, "glDeleteBuffers", gl.DeleteBuffers) &&
      find(get_proc, "glBindBuffer", gl.BindBuffer) && find(get_proc, "glBufferData", gl.BufferData) &&
      find(get_proc, "glGenVertexArrays", gl.GenVertexArrays) && find(get_proc, "glDeleteVertexArrays", gl.DeleteVertexArrays) &&
      find(get_proc, "glBindVertexArray", gl.BindVertexArray) &&
      find(get_proc, "glEnableVertexAttribArray", gl.EnableVertexAttribArray) &&
      find(get_proc, "glVertexAttribPointer", gl.VertexAttribPointer) && find(get_proc, "glDrawArrays", gl.DrawArrays) &&
      find(get_proc, "glDrawElements", gl.DrawElements) && find(get_proc, "glCreateShader", gl.CreateShader) &&
      find(get_proc, "glShaderSource", gl.ShaderSource) && find(get_proc, "glCompileShader", gl.CompileShader) &&
      find(get_proc, "glGetShaderiv", gl.GetShaderiv) && find(get_proc, "glGetShaderInfoLog", gl.GetShaderInfoLog) &&
      find(get_proc, "glDeleteShader", gl.DeleteShader) && find(get_proc, "glCreateProgram", gl.CreateProgram) &&
      find(get_proc, "glAttachShader", gl.AttachShader) && find(get_proc, "glLinkProgram", gl.LinkProgram) &&
      find(get_proc, "glGetProgramiv", gl.GetProgramiv) && find(get_proc, "glGetProgramInfoLog", gl.GetProgramInfoLog) &&
      find(get_proc, "glDeleteProgram", gl.DeleteProgram) && find(get_proc, "glUseProgram", gl.UseProgram) &&
      find(get_proc, "glGetUniformLocation", gl.GetUniformLocation) && find(get_proc, "glUniform1i", gl.Uniform1i) &&
      find(get_proc, "glUniform4fv", gl.Uniform4fv) && find(get_proc, "glGenFramebuffers", gl.GenFramebuffers) &&
      find(get_proc, "glDeleteFramebuffers", gl.DeleteFramebuffers) && find(get_proc, "glBindFramebuffer", gl.BindFramebuffer) &&
      find(get_proc, "glFramebufferTexture2D", gl.FramebufferTexture2D) &&
      find(get_proc, "glCheckFramebufferStatus", gl.CheckFramebufferStatus) &&
      find(get_proc, "glBlitFramebuffer", gl.BlitFramebuffer) && find(get_proc, "glGenRenderbuffers", gl.GenRenderbuffers) &&
      find(get_proc, "glDeleteRenderbuffers", gl.DeleteRenderbuffers) &&
      find(get_proc, "glBindRenderbuffer", gl.BindRenderbuffer) &&
      find(get_proc, "glRenderbufferStorage", gl.RenderbufferStorage) &&
      find(get_proc, "glFramebufferRenderbuffer", gl.FramebufferRenderbuffer) && find(get_proc, "glReadPixels", gl.ReadPixels);
  return complete ? Status{} : Status{StatusCode::kUnsupported, "the GL driver lacks functions of GL 3.3 and GL ES 3.0"};
}

}  // namespace vitrine::hal
