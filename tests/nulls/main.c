// SPDX-License-Identifier: MIT
// Calls every public function with every wrong argument, each in a process of its own: a crash, a hang of 20 s, a failure
// without a sentence, an output that a failure changed, and NULL that is accepted though the header does not say so count
// as failures, and two defs with one cookie. The calls are written by generate.py from the headers. Ends with "N passed, N failed".
#include "fixture.h"

#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

enum { PASSED = 0, SILENT = 90, ACCEPTED, CHANGED, UNNAMED };

static const void* const untouched = &f;

static const char* const reasons[] = {
    "fails without a sentence", "accepts NULL, which its header does not allow",
    "fails and changes an output", "its sentence does not name the argument"};

// The sentence about the call: options keep one of their own.
static const char* sentence(void)
{
    const char* message = vplContext_GetLastMessage(f.context);
    return message[0] == 0 ? vplRenderOptions_GetProblem(f.options) : message;
}

static int judge(const Call* call)
{
    vplContext_SetProgress(f.context, NULL, NULL);
    for (int i = 0; i < SPACES; i++) {
        memcpy(spaces[i], &untouched, call->outputs >> i & 1 ? sizeof untouched : 0);
    }
    const vplResult result = call->run();
    if (!call->result) {
        return PASSED;
    }
    if (result == VPL_SUCCESS) {
        return call->null && !call->optional ? ACCEPTED : PASSED;
    }
    for (int i = 0; i < SPACES; i++) {
        if ((call->outputs >> i & 1) && memcmp(spaces[i], &untouched, sizeof untouched) != 0) {
            return CHANGED;
        }
    }
    if (call->known && sentence()[0] == 0) {
        return SILENT;
    }
    return call->known && call->null && !call->optional && strstr(sentence(), call->argument) == NULL
               ? UNNAMED
               : PASSED;
}

// Returns whether the call passed; else prints what it did.
static bool passes(const Call* call)
{
    fflush(stdout);
    const pid_t child = fork();
    if (child == 0) {
        alarm(20);
        _exit(judge(call));
    }
    int status = 0;
    waitpid(child, &status, 0);
    if (WIFEXITED(status) && WEXITSTATUS(status) == PASSED) {
        return true;
    }
    printf("not ok %s, %s = %s: ", call->function, call->argument, call->value);
    if (WIFSIGNALED(status)) {
        printf("signal %d, %s\n", WTERMSIG(status), strsignal(WTERMSIG(status)));
    } else if (WEXITSTATUS(status) < SILENT || WEXITSTATUS(status) > UNNAMED) {
        printf("ended the process with %d\n", WEXITSTATUS(status));
    } else {
        printf("%s\n", reasons[WEXITSTATUS(status) - SILENT]);
    }
    return false;
}

// Returns whether each def has a cookie of its own: one of another type must be refused. Prints those that have not.
static bool cookiesDiffer(void)
{
    Cookie* cookies = calloc((size_t)defCount, sizeof *cookies);
    bool differ = cookies != NULL;
    if (cookies != NULL) {
        findCookies(cookies);
    }
    for (int i = 0; cookies != NULL && i < defCount; i++) {
        for (int k = 0; k < i; k++) {
            if (cookies[i].cookie == cookies[k].cookie) {
                printf("not ok %s and %s have the same cookie\n", cookies[k].def, cookies[i].def);
                differ = false;
            }
        }
    }
    free(cookies);
    return differ;
}

// nulls [FUNCTION]: all calls, or those of one function.
int main(int count, char** words)
{
    char scratch[] = "/tmp/vpl-nulls-XXXXXX"; // files that wrong names make are written here
    if (mkdtemp(scratch) == NULL || chdir(scratch) != 0) {
        printf("0 passed, 1 failed\nno folder for scratch files\n");
        return 1;
    }
    makeFixture();
    int passed = cookiesDiffer(), failed = !passed;
    for (int i = 0; i < callCount; i++) {
        if (count < 2 || strcmp(words[1], calls[i].function) == 0) {
            *(passes(&calls[i]) ? &passed : &failed) += 1;
        }
    }
    printf("%d functions; %d arguments that must not be NULL, as their headers say, got no NULL\n",
           functionCount, skippedCount);
    printf("%d passed, %d failed\n", passed, failed);
    return failed != 0;
}
