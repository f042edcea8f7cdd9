// SPDX-License-Identifier: MIT
// A context from the inside: the memory that it holds, the machine as it uses it, and files that appear whole.
#ifndef VPL_MACHINE_H
#define VPL_MACHINE_H

#include <vpl/base.h>

VPL_HEADER_BEGIN

// "auto", "scalar", "sse2", "avx2" or "avx512".
const char* vplIsa_GetName(vplIsa isa);

// Bytes held now, and the most held at once since creation or the last reset.
size_t vplContext_GetBytes(const vplContext* context);
size_t vplContext_GetPeakBytes(const vplContext* context);
void vplContext_ResetPeakBytes(vplContext* context);

// Plans of renders that need more memory than this, bytes, are refused with VPL_OUT_OF_MEMORY before they begin; 0
// (default): none is. Allocations themselves have no limit. No picture's bits depend on it.
void vplContext_SetMemoryLimit(vplContext* context, size_t bytes);

// The instruction set in use (never VPL_ISA_AUTO) and the number of workers (never 0).
vplIsa vplContext_GetIsa(const vplContext* context);
int vplContext_GetWorkerCount(const vplContext* context);

// Writes a whole file. It writes to a temporary file beside the target, checks it and renames it, so that the
// target is either unchanged or complete. Devices and pipes are written directly. VPL_FILE_ERROR,
// VPL_OUT_OF_MEMORY.
vplResult vplWriteFile(vplContext* context, const char* path, const void* bytes, size_t size);

// Reads a whole file, of any size, or what a device or a pipe has to its end, at most 256 MiB, while it asks the context's
// progress. A 0 byte follows the bytes, which are freed by vplBytes_Free. VPL_FILE_ERROR, VPL_LIMIT, VPL_CANCELLED,
// VPL_OUT_OF_MEMORY.
vplResult vplReadFile(vplContext* context, const char* path, char** bytesOut, size_t* sizeOut);

// Makes reading look for files among these first, by name, and on disk for what is not among them. They must last until
// another call; NULL with a count of 0 (default): only disk. vplScene_LoadMemory sets them for its own duration.
void vplContext_SetFiles(vplContext* context, const vplMemoryFile* files, int count);

// Called on the thread that reads with each file that was read from disk, or from a pipe, as a whole. The bytes are gone
// when it returns.
typedef void vplFileFcn(void* user, const vplMemoryFile* file);

// Tells `fcn` of all files that are read, so that a scene with what it names can be sent to another machine, where
// vplContext_SetFiles takes the files. NULL (default): no function is called.
void vplContext_SetFileObserver(vplContext* context, vplFileFcn* fcn, void* user);

// Processes that share work, each with a context of its own. They make the same calls with the same arguments.
typedef struct vplTeam {
    int index, count; // this process, in [0, count); all of them, in [1, 65536]
    // Sends each process m the next sendBytes[m] bytes of `send`, and receives receiveBytes[m] bytes from each, one after the
    // other. It is called on the thread that made the call, as often by each process, and returns when all bytes are there.
    void (*exchange)(void* user, const void* send, const size_t* sendBytes, void* receive,
                     const size_t* receiveBytes);
    void* user; // passed to exchange
} vplTeam;

// From now on vplFormFactors_Create holds every count-th row of the matrix in each process, and what is computed with these
// form factors (vplSolveRadiosity but for shooting, vplGatherRadiosity, vplRadiosityResidual) is shared, too; renders by
// radiosity compare notes after each stage. Bits are those of one process. If one process fails, all calls under way fail, and
// the team must be set anew. The team is copied; NULL (default): no team. VPL_INVALID_ARGUMENT, VPL_OUT_OF_MEMORY.
vplResult vplContext_SetTeam(vplContext* context, const vplTeam* team);

VPL_HEADER_END

#endif
