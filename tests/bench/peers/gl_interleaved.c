// SPDX-License-Identifier: MIT
// Based on: Alexander Keller and Wolfgang Heidrich, Interleaved Sampling, EGWR 2001, with the G-buffer split
// by Benjamin Segovia et al., Non-interleaved Deferred Shading of Interleaved Sample Patterns, Graphics
// Hardware 2006: sixteen small pictures, each lit by a sixteenth of the lights, and a box filter over 4 x 4
// pixels.
#include "gl.h"

void glInterleaved(Gl* gl, const Row* row)
{
    const int width = gl->width / INTERLEAVE, height = gl->height / INTERLEAVE;
    const int part = row->lights / (INTERLEAVE * INTERLEAVE);
    drawGbuffer(gl);
    setState(gl, (State){gl->partsFrame, 0, false, true});
    clearTarget(0, false);
    useProgram(gl, PROGRAM_INTERLEAVE);
    glBindVertexArray(gl->emptyArray);
    for (int i = 0; i < INTERLEAVE * INTERLEAVE; i++) {
        const int x = i % INTERLEAVE, y = i / INTERLEAVE;
        glViewport(x * width, y * height, width, height);
        glUniform4i(AT_ORIGIN, x * width, y * height, x, y);
        glBindBufferRange(GL_UNIFORM_BUFFER, BLOCK_LIGHTS, gl->split, (GLintptr)i * part * 32,
                          LIGHT_VECTORS * 16);
        glDrawArraysInstanced(GL_TRIANGLES, 0, 3, part / BATCH_INTERLEAVED);
        gl->draws++;
    }
    setState(gl, (State){gl->colourFrame, GL_GREATER, false, false});
    clearTarget(0, false);
    glViewport(0, 0, gl->width, gl->height);
    useProgram(gl, PROGRAM_GATHER);
    glUniform4i(AT_ORIGIN, width, height, 0, 0);
    drawScreen(gl);
}
