// SPDX-License-Identifier: MIT
// Kinds of files, told by how their bytes begin, so that a file of a wrong kind is named and not only refused.
#ifndef VPL_BASE_FILE_KIND_H
#define VPL_BASE_FILE_KIND_H

#include "base/context.h"

// The kind of a file with these bytes, such as "a PNG picture"; NULL where it is not known. *endingOut is how names of files of
// this kind end, ".png"; NULL where the library reads none of the kind.
const char* vplFileKindOf(const void* bytes, size_t size, const char** endingOut);

// VPL_PARSE_ERROR where the bytes are of another kind than `endings` has, one ending after the other such as ".png.jpg". The
// sentence says that `expected` was expected.
vplResult vplCheckFileKind(vplContext* context, const char* path, const void* bytes, size_t size,
                           const char* endings, const char* expected);

#endif
