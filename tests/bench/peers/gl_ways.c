// SPDX-License-Identifier: MIT
// Draws the room with OpenGL in the ways that a renderer would choose from.
#include "gl.h"

enum { LIGHTS_OF_DRAW = LIGHT_VECTORS / 3 }; // physical lights in one block

void setState(Gl* gl, State state)
{
    (void)gl;
    glBindFramebuffer(GL_FRAMEBUFFER, state.frame);
    if (state.compare != 0) {
        glEnable(GL_DEPTH_TEST);
        glDepthFunc(state.compare);
    } else {
        glDisable(GL_DEPTH_TEST);
    }
    glDepthMask(state.depthWrite);
    if (state.add) {
        glEnable(GL_BLEND);
    } else {
        glDisable(GL_BLEND);
    }
}

void useProgram(Gl* gl, Program program)
{
    glUseProgram(gl->programs[program]);
}

void drawRoom(Gl* gl)
{
    glDrawArrays(GL_TRIANGLES, 0, gl->vertexCount);
    gl->draws++;
}

void drawScreen(Gl* gl)
{
    glBindVertexArray(gl->emptyArray);
    glDrawArrays(GL_TRIANGLES, 0, 3);
    gl->draws++;
}

static void useCamera(Gl* gl, Program program)
{
    glViewport(0, 0, gl->width, gl->height);
    useProgram(gl, program);
    glBindVertexArray(program == PROGRAM_INSTANCE ? gl->lightsArray : gl->roomArray);
    glUniformMatrix4fv(AT_TO_CLIP, 1, GL_FALSE, gl->toClip);
}

void clearTarget(float colour, bool depth)
{
    const float colours[4] = {colour, colour, colour, colour}, one = 1;
    if (depth) {
        glClearBufferfv(GL_DEPTH, 0, &one);
    } else {
        glClearBufferfv(GL_COLOR, 0, colours);
    }
}

// Lays down depth first, so that every pixel is shaded once.
static void drawDepth(Gl* gl)
{
    setState(gl, (State){gl->depthFrame, GL_LESS, true, false});
    clearTarget(0, true);
    useCamera(gl, PROGRAM_DEPTH);
    drawRoom(gl);
}

void drawGbuffer(Gl* gl)
{
    setState(gl, (State){gl->gbufferFrame, GL_LESS, true, false});
    clearTarget(0, true);
    clearTarget(-1, false);
    useCamera(gl, PROGRAM_GBUFFER);
    drawRoom(gl);
}

// Returns the uniform block of the row's lights.
static GLuint lightsOf(Gl* gl, const Row* row)
{
    return findLights(gl, row->lighting == VPL_LIGHTING_DOCUMENTED, row->lights);
}

static void addPasses(Gl* gl, int count)
{
    setState(gl, (State){gl->colourFrame, GL_EQUAL, false, true});
    useCamera(gl, PROGRAM_ONE_LIGHT);
    for (int i = 0; i < count; i++) {
        const vplShadeLight* light = &gl->room->documented[i];
        glUniform3f(AT_LIGHT_POSITION, light->px, light->py, light->pz);
        glUniform3f(AT_LIGHT_COLOUR, light->r, light->g, light->b);
        drawRoom(gl);
    }
}

// Draws the passes of all lights as instances of one draw.
static void addInstances(Gl* gl, int count)
{
    setState(gl, (State){gl->colourFrame, GL_EQUAL, false, true});
    useCamera(gl, PROGRAM_INSTANCE);
    glDrawArraysInstanced(GL_TRIANGLES, 0, gl->vertexCount, count);
    gl->draws++;
}

// Does the same as addInstances with several lights per instance. The last batch is padded with black lights.
static void addBatches(Gl* gl, const Row* row)
{
    const bool documented = row->lighting == VPL_LIGHTING_DOCUMENTED;
    const bool few = documented && row->lights <= BATCH_FEW;
    const int batch = few ? BATCH_FEW : documented ? BATCH_DOCUMENTED : BATCH_PHYSICAL;
    const int vectors = documented ? 2 : 3;
    const int most = LIGHT_VECTORS / vectors / batch; // batches in one block
    const int batches = (row->lights + batch - 1) / batch;
    setState(gl, (State){gl->colourFrame, GL_EQUAL, false, true});
    useCamera(gl, few ? PROGRAM_BATCH_FEW : PROGRAM_BATCH + (int)documented);
    for (int first = 0; first < batches; first += most) {
        glBindBufferRange(GL_UNIFORM_BUFFER, BLOCK_LIGHTS, lightsOf(gl, row),
                          (GLintptr)first * batch * vectors * 16, LIGHT_VECTORS * 16);
        glDrawArraysInstanced(GL_TRIANGLES, 0, gl->vertexCount,
                              batches - first < most ? batches - first : most);
        gl->draws++;
    }
}

void glBatches(Gl* gl, const Row* row)
{
    drawDepth(gl);
    setState(gl, (State){gl->colourFrame, GL_EQUAL, false, false});
    clearTarget(0, false);
    addBatches(gl, row);
}

void glMultipass(Gl* gl, const Row* row)
{
    drawDepth(gl);
    setState(gl, (State){gl->colourFrame, GL_EQUAL, false, false});
    clearTarget(0, false);
    addPasses(gl, row->lights);
}

void glInstances(Gl* gl, const Row* row)
{
    drawDepth(gl);
    setState(gl, (State){gl->colourFrame, GL_EQUAL, false, false});
    clearTarget(0, false);
    addInstances(gl, row->lights);
}

// Draws as few times as the size of uniform blocks allows.
static void shadeWithLights(Gl* gl, const Row* row, bool forward)
{
    const bool documented = row->lighting == VPL_LIGHTING_DOCUMENTED;
    const int most = documented ? MOST_LIGHTS : LIGHTS_OF_DRAW, vectors = documented ? 2 : 3;
    State state = {gl->colourFrame, forward ? GL_EQUAL : GL_GREATER, false, false};
    setState(gl, state);
    clearTarget(0, false);
    useProgram(gl, (forward ? PROGRAM_FORWARD : PROGRAM_DEFERRED) + (int)documented);
    for (int first = 0; first < row->lights; first += most) {
        const int count = row->lights - first < most ? row->lights - first : most;
        glBindBufferRange(GL_UNIFORM_BUFFER, BLOCK_LIGHTS, lightsOf(gl, row), (GLintptr)first * vectors * 16,
                          LIGHT_VECTORS * 16);
        glUniform1i(AT_LIGHT_COUNT, count);
        if (forward) {
            drawRoom(gl);
        } else {
            drawScreen(gl);
        }
        state.add = true;
        setState(gl, state);
    }
}

void glForward(Gl* gl, const Row* row)
{
    drawDepth(gl);
    const bool documented = row->lighting == VPL_LIGHTING_DOCUMENTED;
    useCamera(gl, PROGRAM_FORWARD + (int)documented);
    shadeWithLights(gl, row, true);
}

void glDeferred(Gl* gl, const Row* row)
{
    drawGbuffer(gl);
    shadeWithLights(gl, row, false);
}

static void drawCube(Gl* gl, bool colour)
{
    glViewport(0, 0, CUBE_SIZE, CUBE_SIZE);
    useProgram(gl, colour ? PROGRAM_CUBE_COLOUR : PROGRAM_CUBE_DEPTH);
    glBindVertexArray(gl->roomArray);
    for (int face = 0; face < 6; face++) {
        const GLuint frame = colour ? gl->cubeColourFrames[face] : gl->cubeDepthFrames[face];
        setState(gl, (State){frame, GL_LESS, true, false});
        clearTarget(1, true);
        if (colour) {
            clearTarget(1, false);
        }
        glUniformMatrix4fv(AT_TO_CLIP, 1, GL_FALSE, gl->faceToClip[face]);
        drawRoom(gl);
    }
}

void glCubeDepth(Gl* gl, const Row* row)
{
    (void)row;
    drawCube(gl, false);
}

void glCubeColour(Gl* gl, const Row* row)
{
    (void)row;
    drawCube(gl, true);
}

// Shades in one draw. It needs the depth of drawDepth or the G-buffer.
static void shadeOnce(Gl* gl, Program program, bool forward, int lights)
{
    setState(gl, (State){gl->colourFrame, forward ? GL_EQUAL : GL_GREATER, false, false});
    clearTarget(0, false);
    if (forward) {
        useCamera(gl, program);
    } else {
        useProgram(gl, program);
    }
    if (lights > 0) {
        glBindBufferRange(GL_UNIFORM_BUFFER, BLOCK_LIGHTS, findLights(gl, true, lights), 0,
                          LIGHT_VECTORS * 16);
        glUniform1i(AT_LIGHT_COUNT, lights);
    }
    if (forward) {
        drawRoom(gl);
    } else {
        drawScreen(gl);
    }
}

void glDirectForward(Gl* gl, const Row* row)
{
    (void)row;
    drawDepth(gl);
    shadeOnce(gl, PROGRAM_DIRECT_FORWARD, true, 0);
}

void glDirectDeferred(Gl* gl, const Row* row)
{
    (void)row;
    drawGbuffer(gl);
    shadeOnce(gl, PROGRAM_DIRECT_DEFERRED, false, 0);
}

void glFrameMultipass(Gl* gl, const Row* row)
{
    drawCube(gl, false);
    glDirectForward(gl, row);
    addPasses(gl, row->lights);
}

void glFrameInstances(Gl* gl, const Row* row)
{
    drawCube(gl, false);
    glDirectForward(gl, row);
    addInstances(gl, row->lights);
}

void glFrameBatches(Gl* gl, const Row* row)
{
    drawCube(gl, false);
    glDirectForward(gl, row);
    addBatches(gl, row);
}

void glFrameForward(Gl* gl, const Row* row)
{
    drawCube(gl, false);
    drawDepth(gl);
    shadeOnce(gl, PROGRAM_FRAME_FORWARD, true, row->lights);
}

void glFrameDeferred(Gl* gl, const Row* row)
{
    drawCube(gl, false);
    drawGbuffer(gl);
    shadeOnce(gl, PROGRAM_FRAME_DEFERRED, false, row->lights);
}
