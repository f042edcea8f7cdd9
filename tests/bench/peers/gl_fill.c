// SPDX-License-Identifier: MIT
// Measures OpenGL's rasterizer alone: layers that cover the whole picture, and many small triangles.
#include "gl.h"

static void clearDepth(void)
{
    const float one = 1;
    glClearBufferfv(GL_DEPTH, 0, &one);
}

// Draws `count` layers; 0: one triangle at medium depth.
static void drawLayers(Gl* gl, int count, int nearer)
{
    glUniform1i(AT_LAYER_COUNT, nearer);
    glDrawArrays(GL_TRIANGLES, 0, 3 * count);
    gl->draws++;
}

void glDepthFill(Gl* gl, const Row* row)
{
    (void)row;
    setState(gl, (State){gl->depthFrame, GL_LESS, true, false});
    clearDepth();
    glViewport(0, 0, gl->width, gl->height);
    glBindVertexArray(gl->emptyArray);
    useProgram(gl, PROGRAM_LAYERS_DEPTH);
    drawLayers(gl, DEPTH_LAYERS, DEPTH_LAYERS);
}

void glAddFill(Gl* gl, const Row* row)
{
    (void)row;
    const float black[4] = {0};
    setState(gl, (State){gl->depthFrame, GL_LESS, true, false});
    clearDepth();
    glViewport(0, 0, gl->width, gl->height);
    glBindVertexArray(gl->emptyArray);
    useProgram(gl, PROGRAM_LAYERS_DEPTH);
    drawLayers(gl, 1, 0);
    setState(gl, (State){gl->colourFrame, GL_EQUAL, false, true});
    glClearBufferfv(GL_COLOR, 0, black);
    useProgram(gl, PROGRAM_LAYERS_COLOUR);
    drawLayers(gl, ADD_LAYERS, 0);
}

void glTriangles(Gl* gl, const Row* row)
{
    (void)row;
    setState(gl, (State){gl->depthFrame, GL_LESS, true, false});
    clearDepth();
    glViewport(0, 0, gl->width, gl->height);
    glBindVertexArray(gl->gridArray);
    useProgram(gl, PROGRAM_GRID);
    glDrawElements(GL_TRIANGLES, gl->gridCount, GL_UNSIGNED_INT, NULL);
    gl->draws++;
}
