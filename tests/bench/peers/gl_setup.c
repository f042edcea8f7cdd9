// SPDX-License-Identifier: MIT
// Sets up OpenGL 4.5 core without a window: EGL's surfaceless platform, programs, textures.
#include "gl.h"

#include <EGL/egl.h>
#include <EGL/eglext.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void openContext(Gl* gl)
{
    gl->display = eglGetPlatformDisplay(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, NULL);
    demand(gl->display != EGL_NO_DISPLAY && eglInitialize(gl->display, NULL, NULL) == EGL_TRUE,
           "EGL has no surfaceless platform here");
    demand(eglBindAPI(EGL_OPENGL_API) == EGL_TRUE, "EGL has no desktop OpenGL here");
    const EGLint config[] = {EGL_SURFACE_TYPE, EGL_PBUFFER_BIT, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT,
                             EGL_NONE};
    const EGLint version[] = {EGL_CONTEXT_MAJOR_VERSION,
                              4,
                              EGL_CONTEXT_MINOR_VERSION,
                              5,
                              EGL_CONTEXT_OPENGL_PROFILE_MASK,
                              EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                              EGL_NONE};
    EGLConfig chosen = NULL;
    EGLint count = 0;
    demand(eglChooseConfig(gl->display, config, &chosen, 1, &count) == EGL_TRUE, "EGL has no OpenGL config");
    gl->context =
        eglCreateContext(gl->display, count > 0 ? chosen : EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, version);
    demand(gl->context != EGL_NO_CONTEXT, "EGL gave no context of OpenGL 4.5");
    demand(eglMakeCurrent(gl->display, EGL_NO_SURFACE, EGL_NO_SURFACE, gl->context) == EGL_TRUE,
           "the OpenGL context cannot be made current");
    GLint blockBytes = 0;
    glGetIntegerv(GL_MAX_UNIFORM_BLOCK_SIZE, &blockBytes);
    demand(blockBytes >= LIGHT_VECTORS * 16, "OpenGL's uniform blocks are smaller than 64 KB");
}

static GLuint compile(GLenum type, const char* taps, const char* defines, const char* text)
{
    const char* parts[] = {"#version 450 core\n", taps, defines, text};
    GLuint shader = glCreateShader(type);
    glShaderSource(shader, 4, parts, NULL);
    glCompileShader(shader);
    GLint ok;
    glGetShaderiv(shader, GL_COMPILE_STATUS, &ok);
    if (!ok) {
        char log[1000];
        glGetShaderInfoLog(shader, sizeof log, NULL, log);
        fprintf(stderr, "%s%s%s\n", defines, text, log);
    }
    demand(ok, "a shader does not compile");
    return shader;
}

void makeGlPrograms(Gl* gl)
{
    char taps[2000];
    writeTaps(gl, taps, sizeof taps);
    for (int i = 0; i < PROGRAM_COUNT; i++) {
        const ProgramText* text = &PROGRAM_TEXTS[i];
        GLuint vertex = compile(GL_VERTEX_SHADER, taps, text->defines, text->vertex);
        GLuint fragment = compile(GL_FRAGMENT_SHADER, taps, text->defines, text->fragment);
        GLuint program = glCreateProgram();
        glAttachShader(program, vertex);
        glAttachShader(program, fragment);
        glLinkProgram(program);
        GLint ok;
        glGetProgramiv(program, GL_LINK_STATUS, &ok);
        demand(ok, "a program does not link");
        glDeleteShader(vertex);
        glDeleteShader(fragment);
        gl->programs[i] = program;
    }
}

static GLuint makeTexture(GLenum target, GLenum format, int width, int height)
{
    GLuint texture;
    glCreateTextures(target, 1, &texture);
    glTextureStorage2D(texture, 1, format, width, height);
    glTextureParameteri(texture, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glTextureParameteri(texture, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    glTextureParameteri(texture, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    glTextureParameteri(texture, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    return texture;
}

// Makes a framebuffer object. Layer -1: the whole texture.
static GLuint makeFrame(GLuint colour, GLuint depth, int colourLayer, int depthLayer)
{
    GLuint frame;
    glCreateFramebuffers(1, &frame);
    if (colour != 0 && colourLayer < 0) {
        glNamedFramebufferTexture(frame, GL_COLOR_ATTACHMENT0, colour, 0);
    } else if (colour != 0) {
        glNamedFramebufferTextureLayer(frame, GL_COLOR_ATTACHMENT0, colour, 0, colourLayer);
    }
    glNamedFramebufferDrawBuffer(frame, colour ? GL_COLOR_ATTACHMENT0 : GL_NONE);
    if (depth != 0 && depthLayer < 0) {
        glNamedFramebufferTexture(frame, GL_DEPTH_ATTACHMENT, depth, 0);
    } else if (depth != 0) {
        glNamedFramebufferTextureLayer(frame, GL_DEPTH_ATTACHMENT, depth, 0, depthLayer);
    }
    demand(glCheckNamedFramebufferStatus(frame, GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE,
           "a framebuffer of OpenGL is not complete");
    return frame;
}

void makeGlTargets(Gl* gl)
{
    gl->colour = makeTexture(GL_TEXTURE_2D, GL_RGBA32F, gl->width, gl->height);
    gl->gbuffer = makeTexture(GL_TEXTURE_2D, GL_RGBA32F, gl->width, gl->height);
    gl->parts = makeTexture(GL_TEXTURE_2D, GL_RGBA32F, gl->width, gl->height);
    gl->depth = makeTexture(GL_TEXTURE_2D, GL_DEPTH_COMPONENT32F, gl->width, gl->height);
    gl->colourFrame = makeFrame(gl->colour, gl->depth, -1, -1);
    gl->gbufferFrame = makeFrame(gl->gbuffer, gl->depth, -1, -1);
    gl->partsFrame = makeFrame(gl->parts, 0, -1, -1);
    gl->depthFrame = makeFrame(0, gl->depth, -1, -1);
    gl->cubeDepth = makeTexture(GL_TEXTURE_CUBE_MAP, GL_DEPTH_COMPONENT32F, CUBE_SIZE, CUBE_SIZE);
    gl->cubeColour = makeTexture(GL_TEXTURE_CUBE_MAP, GL_R32F, CUBE_SIZE, CUBE_SIZE);
    gl->cubeBuffer = makeTexture(GL_TEXTURE_2D, GL_DEPTH_COMPONENT32F, CUBE_SIZE, CUBE_SIZE);
    for (int face = 0; face < 6; face++) {
        gl->cubeDepthFrames[face] = makeFrame(0, gl->cubeDepth, -1, face);
        gl->cubeColourFrames[face] = makeFrame(gl->cubeColour, gl->cubeBuffer, face, -1);
    }
    glBindTextureUnit(TEXTURE_GBUFFER, gl->gbuffer);
    glBindTextureUnit(TEXTURE_CUBE, gl->cubeDepth);
    glBindTextureUnit(TEXTURE_PARTS, gl->parts);
}

Gl* openGl(const Room* room, int threads)
{
    // llvmpipe reads LP_NUM_THREADS when it starts; with 0 it draws in the calling thread.
    char count[12];
    snprintf(count, sizeof count, "%d", threads == 1 ? 0 : threads);
    setenv("LP_NUM_THREADS", count, 1);
    setenv("LIBGL_ALWAYS_SOFTWARE", "1", 1);
    Gl* gl = calloc(1, sizeof *gl);
    demand(gl != NULL, "out of memory");
    gl->room = room;
    gl->width = room->view.width;
    gl->height = room->view.height;
    openContext(gl);
    makeGlPrograms(gl);
    makeGlRoom(gl);
    makeGlTargets(gl);
    glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE); // depth from 0 to 1, as in libvpl
    glBlendFunc(GL_ONE, GL_ONE);
    glCubeDepth(gl, NULL); // direct light needs a cube map
    demand(glGetError() == GL_NO_ERROR, "OpenGL reports an error");
    return gl;
}

void closeGl(Gl* gl)
{
    eglMakeCurrent(gl->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    eglDestroyContext(gl->display, gl->context);
    eglTerminate(gl->display);
    free(gl);
}

void finishGl(void)
{
    glFinish();
}

int64_t drawsOfGl(const Gl* gl)
{
    return gl->draws;
}

void resetDrawsOfGl(Gl* gl)
{
    gl->draws = 0;
}

const char* rendererOfGl(const Gl* gl)
{
    (void)gl;
    return (const char*)glGetString(GL_RENDERER);
}

const char* versionOfGl(const Gl* gl)
{
    (void)gl;
    return (const char*)glGetString(GL_VERSION);
}

void readGl(Gl* gl, Product product, float* out)
{
    demand(glGetError() == GL_NO_ERROR, "OpenGL reports an error");
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    if (product == PRODUCT_CUBE) { // its rows are already in libvpl's order
        glGetTextureImage(gl->cubeDepth, 0, GL_DEPTH_COMPONENT, GL_FLOAT, 6 * CUBE_SIZE * CUBE_SIZE * 4, out);
        return;
    }
    glBindFramebuffer(GL_FRAMEBUFFER, gl->colourFrame);
    bool depth = product == PRODUCT_DEPTH, one = product != PRODUCT_PICTURE;
    glReadPixels(0, 0, gl->width, gl->height,
                 depth ? GL_DEPTH_COMPONENT
                 : one ? GL_RED
                       : GL_RGB,
                 GL_FLOAT, out);
}
