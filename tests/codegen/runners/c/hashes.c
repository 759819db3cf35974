/* Prints the first 48 bits of SHA-256 of 0, 1, 2 ... bytes, given in two pieces. */
#include <stdio.h>

#include "common/mavlink.h"

int main(void)
{
    uint8_t bytes[300], result[6];
    unsigned int length, i;
    for (i = 0; i < sizeof(bytes); i++) {
        bytes[i] = (uint8_t)i;
    }
    for (length = 0; length <= sizeof(bytes); length++) {
        mavlink_sha256_ctx hash;
        mavlink_sha256_init(&hash);
        mavlink_sha256_update(&hash, bytes, length / 3);
        mavlink_sha256_update(&hash, bytes + length / 3, length - length / 3);
        mavlink_sha256_final_48(&hash, result);
        for (i = 0; i < sizeof(result); i++) {
            printf("%02x", result[i]);
        }
        printf("\n");
    }
    return 0;
}
