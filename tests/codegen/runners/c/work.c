/* Parses stdin byte by byte; prints the number of packets, and the maximum number of bytes that one call adds to checksums. */
#include <stdint.h>
#include <stdio.h>

static unsigned int added;

#define HAVE_CRC_ACCUMULATE
static inline void crc_accumulate(uint8_t data, uint16_t *crc)
{
    unsigned int mixed = (*crc ^ data) & 0xFFu;
    mixed = (mixed ^ (mixed << 4)) & 0xFFu;
    *crc = (uint16_t)((*crc >> 8) ^ (mixed << 8) ^ (mixed << 3) ^ (mixed >> 4));
    added++;
}

#include "common/mavlink.h"

int main(void)
{
    static mavlink_parser_t parser;
    mavlink_message_t msg;
    unsigned int packets = 0, maximum = 0;
    int byte;
    mavlink_parser_init(&parser);
    while ((byte = getchar()) != EOF) {
        added = 0;
        packets += mavlink_parse(&parser, (uint8_t)byte, &msg) == MAVLINK_FRAMING_OK;
        maximum = added > maximum ? added : maximum;
    }
    printf("%u %u\n", packets, maximum);
    return 0;
}
