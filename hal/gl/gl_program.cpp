// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "hal/gl/gl_program.h"

#include <array>
#include <cstdio>

namespace vitrine::hal {
namespace {

// GLSL ES 3.00 has no default precision for floats in fragment shaders, and a low one for samplers; GLSL 3.30 accepts the
// statements and ignores them.
constexpr char kPrecision[] = "precision highp float;\nprecision highp int;\nprecision highp sampler2D;\n#line 1\n";

void print_log(const char* what, const char* log) { std::fprintf(stderr, "vitrine: %s: %s\n", what, log); }

GLuint compile(const GlFunctions& gl, GLenum kind, const char* library, const char* body, bool es) {
  const GLuint shader = gl.CreateShader(kind);
  const std::array<const char*, 4> sources{es ? "#version 300 es\n" : "#version 330 core\n", kPrecision, library, body};
  gl.ShaderSource(shader, static_cast<GLsizei>(sources.size()), sources.data(), nullptr);
  gl.CompileShader(shader);
  GLint compiled = 0;
  gl.GetShaderiv(shader, GL_COMPILE_STATUS, &compiled);
  if (compiled) return shader;
  std::array<char, 2048> log{};
  gl.GetShaderInfoLog(shader, static_cast<GLsizei>(log.size()), nullptr, log.data());
  print_log(kind == GL_VERTEX_SHADER ? "vertex shader" : "fragment shader", log.data());
  gl.DeleteShader(shader);
  return 0;
}

bool link(const GlFunctions& gl, GLuint program, GLuint vertex, GLuint fragment) {
  gl.AttachShader(program, vertex);
  gl.AttachShader(program, fragment);
  gl.LinkProgram(program);
  GLint linked = 0;
  gl.GetProgramiv(program, GL_LINK_STATUS, &linked);
  if (linked) return true;
  std::array<char, 2048> log{};
  gl.GetProgramInfoLog(program, static_cast<GLsizei>(log.size()), nullptr, log.data());
  print_log("program", log.data());
  return false;
}

void bind_samplers(const GlFunctions& gl, GLuint program, std::span<const char* const> samplers) {
  gl.UseProgram(program);
  for (size_t i = 0; i < samplers.size(); ++i) {
    const GLint location = gl.GetUniformLocation(program, samplers[i]);
    if (location >= 0) gl.Uniform1i(location, static_cast<GLint>(i));  // else: declared and not used
  }
}

}  // namespace

Result<GLuint> build_gl_program(const GlFunctions& gl, const ProgramDesc& desc, bool es) {
  const GLuint vertex = compile(gl, GL_VERTEX_SHADER, "", desc.vertex, es);
  const GLuint fragment = vertex ? compile(gl, GL_FRAGMENT_SHADER, desc.fragment_library, desc.fragment, es) : 0;
  const GLuint program = fragment ? gl.CreateProgram() : 0;
  const bool linked = program && link(gl, program, vertex, fragment);
  if (vertex) gl.DeleteShader(vertex);  // live on in the program
  if (fragment) gl.DeleteShader(fragment);
  if (linked) return bind_samplers(gl, program, desc.samplers), program;
  if (program) gl.DeleteProgram(program);
  return Status{StatusCode::kDevice, "the GL driver refuses a shader"};
}

}  // namespace vitrine::hal
