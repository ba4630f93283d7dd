// How a hot loop is built twice: for the SSE2 that every x86-64 processor has, and for AVX2 where it is there.
//
// Both paths give the same bits: AVX2 alone brings no fused multiply-add, and -ffp-contract=off forbids it anyway.
// Sanitizers instrument the resolver that picks the path before they are ready themselves, so they get one path.
#pragma once

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define PROCESSOR_CLONES __attribute__((target_clones("avx2", "default")))
#else
#define PROCESSOR_CLONES
#endif
