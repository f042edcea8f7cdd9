// SPDX-License-Identifier: MIT
// Helpers that the tests of OBJ files share: temporary files, and a record of all messages.
#ifndef VPL_TESTS_OBJ_SUPPORT_H
#define VPL_TESTS_OBJ_SUPPORT_H

#include "test.h"

typedef struct Desk {
    char folder[64], obj[96], mtl[96];
    vplContext* context;
    vplScene* scene;
    char said[4000]; // all messages, one per line: "warning: ...\n"
} Desk;

// Makes a temporary folder, a context that keeps all messages, and an empty scene.
void openDesk(Desk* desk);

// Destroys all of it; fails the test if memory is leaked or a file other than a.obj and a.mtl is left.
void closeDesk(Desk* desk);

void writeText(const char* path, const char* text);

// Reads an OBJ file from text into the desk's scene; fails the test if that fails.
const vplMeshDef* readText(Desk* desk, const char* text);

// Returns how often a part occurs in a text.
int countOf(const char* text, const char* part);

vplVec3 meshCorner(const vplMeshDef* mesh, int triangle, int corner);

// Asserts that values are equal to the bit, apart from the sign of 0.
void assertPoint(vplVec3 p, double x, double y, double z);
void assertColour(vplRgb c, double r, double g, double b);

#endif
