/* The hash of results that the programs of this folder print, to compare platforms: FNV-1a. */
#ifndef HASH_H
#define HASH_H

#include <stdio.h>

typedef unsigned long long hash_value;

static const hash_value hash_of_nothing = 14695981039346656037ull;

/* The hash of some bytes and of others behind them. */
static inline hash_value hash_more(hash_value hash, const void *data, size_t size) {
    const unsigned char *bytes = data;
    size_t k;
    for (k = 0; k < size; k++) hash = (hash ^ bytes[k]) * 1099511628211ull;
    return hash;
}

/* In halves, because old C libraries of Windows have no %llx. */
static inline void print_hash(const char *name, hash_value hash) {
    printf("%s %08lx%08lx\n", name, (unsigned long)(hash >> 32), (unsigned long)(hash & 0xffffffffu));
    fflush(stdout);
}

#endif
