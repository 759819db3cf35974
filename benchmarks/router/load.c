/* The load of the router benchmark, and a bare relay to compare with.
 *
 *   load throughput TO LISTEN WINDOW COUNT COPIES MIXED
 *                                     as fast as possible without loss: at most WINDOW packets are under way;
 *                                     each arrives COPIES times; lengths are equal, or mixed
 *   load delay TO LISTEN RATE COUNT   at a fixed rate: median and 99th percentile of the delay
 *   load flood TO RATE SECONDS JOINED THREADS
 *                                     packets that no one waits for; JOINED: the system divides them into datagrams
 *   load relay IN OUT                 receives on one port and sends to another, several datagrams per call
 *
 * All ports are those of 127.0.0.1; throughput and delay send from port LISTEN + 1, so that a router has one peer. Packets are DEBUG_VECT from 1/1; time_usec is the time of sending in nanoseconds.
 * A result is one line of JSON. */
#define _GNU_SOURCE
#include <arpa/inet.h>
#include <errno.h>
#include <netinet/in.h>
#include <netinet/udp.h>
#include <pthread.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

enum { BATCH = 32, PACKET = 42, MAX_PACKET = 2048, ID = 250, CRC_EXTRA = 49, PAYLOAD = 30 };
enum { SHORTEST = 20, LOSS_NANOSECONDS = 200000000, MAX_THREADS = 8 };
/* Time between two looks for packets that arrived: each look costs a system call, whatever it finds. */
enum { POLL_NANOSECONDS = 20000 };
static const uint64_t MAX_NANOSECONDS = 5000000000u;
static int mixed;

static _Thread_local struct mmsghdr messages[BATCH];
static _Thread_local struct iovec parts[BATCH];
static _Thread_local uint8_t buffers[BATCH][MAX_PACKET];

static uint64_t now(void) {
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return (uint64_t)time.tv_sec * 1000000000u + (uint64_t)time.tv_nsec;
}

static struct sockaddr_in at(int port) {
    struct sockaddr_in address = {.sin_family = AF_INET, .sin_port = htons((uint16_t)port)};
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    return address;
}

static int opened(int port, int to) {
    struct sockaddr_in here = at(port), there = at(to);
    int fd = socket(AF_INET, SOCK_DGRAM, 0);
    if (fd < 0 || bind(fd, (struct sockaddr *)&here, sizeof here)) {
        perror("load");
        exit(1);
    }
    if (to && connect(fd, (struct sockaddr *)&there, sizeof there)) {
        perror("load");
        exit(1);
    }
    return fd;
}

static uint16_t accumulate(uint16_t crc, uint8_t byte) {
    byte ^= (uint8_t)crc;
    byte ^= (uint8_t)(byte << 4);
    return (uint16_t)((crc >> 8) ^ (byte << 8) ^ (byte << 3) ^ (byte >> 4));
}

/* The name at the end of the payload has any length if lengths are mixed. */
static size_t make_packet(uint8_t *packet, uint64_t number) {
    uint64_t time = now();
    size_t payload = mixed ? SHORTEST + 1 + number * 7 % (PAYLOAD - SHORTEST) : PAYLOAD;
    memset(packet, 0, PACKET);
    memcpy(packet, (uint8_t[]){0xFD, (uint8_t)payload, 0, 0, (uint8_t)number, 1, 1, ID, 0, 0}, 10);
    memcpy(packet + 10, &time, sizeof time);
    memcpy(packet + 18, &number, sizeof number);
    memcpy(packet + 30, "benchmark!", payload - SHORTEST);
    uint16_t crc = 0xFFFF;
    for (size_t index = 1; index < 10 + payload; index++) crc = accumulate(crc, packet[index]);
    crc = accumulate(crc, CRC_EXTRA);
    packet[10 + payload] = (uint8_t)crc;
    packet[11 + payload] = (uint8_t)(crc >> 8);
    return payload + 12;
}

static void prepare(size_t length) {
    for (int index = 0; index < BATCH; index++) {
        parts[index] = (struct iovec){buffers[index], length};
        messages[index] = (struct mmsghdr){.msg_hdr = {.msg_iov = &parts[index], .msg_iovlen = 1}};
    }
}

static void send_packets(int fd, uint64_t first, int count) {
    prepare(PACKET);
    for (int index = 0; index < count; index++)
        parts[index].iov_len = make_packet(buffers[index], first + (uint64_t)index);
    for (int sent = 0; sent < count;) {
        int done = sendmmsg(fd, messages + sent, (unsigned)(count - sent), 0);
        sent += done > 0 ? done : 0;
    }
}

/* Sends packets of one length, which pass the network stack together. */
static void send_joined(int fd, uint64_t first) {
    static _Thread_local uint8_t joined[BATCH * PACKET];
    union {
        struct cmsghdr header;
        char bytes[CMSG_SPACE(sizeof(uint16_t))];
    } control = {.header = {CMSG_LEN(sizeof(uint16_t)), IPPROTO_UDP, UDP_SEGMENT}};
    uint16_t length = PACKET;
    memcpy(CMSG_DATA(&control.header), &length, sizeof length);
    for (int index = 0; index < BATCH; index++) make_packet(joined + index * PACKET, first + (uint64_t)index);
    struct iovec part = {joined, sizeof joined};
    struct msghdr message = {.msg_iov = &part, .msg_iovlen = 1, .msg_control = &control, .msg_controllen = sizeof control};
    while (sendmsg(fd, &message, 0) < 0 && (errno == ECONNREFUSED || errno == ENOBUFS)) {}
}

static int receive_packets(int fd) {
    prepare(MAX_PACKET);
    int count = recvmmsg(fd, messages, BATCH, MSG_DONTWAIT, NULL);
    return count < 0 ? 0 : count;
}

static void throughput(int to, int listen, uint64_t window, uint64_t count, uint64_t copies) {
    int out = opened(listen + 1, to), in = opened(listen, 0);
    uint64_t sent = 0, received = 0, lost = 0, start = now(), progress = start, next_poll = start;
    while (received + lost < count * copies && now() - start < MAX_NANOSECONDS) {
        uint64_t under_way = sent * copies - received - lost, free = under_way < window ? (window - under_way) / copies : 0;
        if (sent < count && (free >= BATCH || (free && !under_way))) {
            uint64_t rest = count - sent < BATCH ? count - sent : BATCH;
            int batch = (int)(rest < free ? rest : free);
            send_packets(out, sent, batch);
            sent += (uint64_t)batch;
        }
        if (now() < next_poll) continue;
        int got = receive_packets(in);
        next_poll = got < BATCH ? now() + POLL_NANOSECONDS : 0;
        if (got) {
            received += (uint64_t)got;
            progress = now();
        } else if (now() - progress > LOSS_NANOSECONDS) {
            lost += sent * copies - received - lost;
            progress = now();
        }
    }
    printf("{\"seconds\": %.6f, \"received\": %lu, \"lost\": %lu}\n", (double)(now() - start) / 1e9, received, lost);
}

static int compare(const void *left, const void *right) {
    double difference = *(const double *)left - *(const double *)right;
    return (difference > 0) - (difference < 0);
}

static void delay(int to, int listen, double rate, uint64_t count) {
    int out = opened(listen + 1, to), in = opened(listen, 0);
    double *delays = malloc(count * sizeof *delays);
    uint64_t sent = 0, received = 0, start = now(), end = 0;
    while (received < count && (!end || now() < end)) {
        while (sent < count && (double)(now() - start) >= (double)sent * 1e9 / rate) send_packets(out, sent++, 1);
        if (sent == count && !end) end = now() + LOSS_NANOSECONDS;
        int got = receive_packets(in);
        uint64_t time = now();
        for (int index = 0; index < got && received < count; index++) {
            uint64_t at_sending;
            memcpy(&at_sending, buffers[index] + 10, sizeof at_sending);
            delays[received++] = (double)(time - at_sending) / 1e3;
        }
    }
    qsort(delays, received, sizeof *delays, compare);
    double median = received ? delays[received / 2] : 0, p99 = received ? delays[received * 99 / 100] : 0;
    printf("{\"median\": %.1f, \"p99\": %.1f, \"lost\": %lu}\n", median, p99, count - received);
}

static struct {
    int to, joined;
    double rate, seconds;
} flood_options;

/* One thread of a flood; returns the number of packets. */
static void *flood_thread(void *none) {
    int out = opened(0, flood_options.to);
    uint64_t sent = 0, start = now(), end = start + (uint64_t)(flood_options.seconds * 1e9);
    while (now() < end) {
        if ((double)(now() - start) < (double)sent * 1e9 / flood_options.rate) continue;
        if (flood_options.joined) send_joined(out, sent);
        else send_packets(out, sent, BATCH);
        sent += BATCH;
    }
    (void)none;
    return (void *)(uintptr_t)sent;
}

static void flood(int to, double rate, double seconds, int joined, int threads) {
    pthread_t all[MAX_THREADS];
    threads = threads < 1 ? 1 : threads > MAX_THREADS ? MAX_THREADS : threads;
    flood_options.to = to, flood_options.joined = joined;
    flood_options.rate = rate / threads, flood_options.seconds = seconds;
    uint64_t sent = 0;
    for (int index = 0; index < threads; index++) pthread_create(&all[index], NULL, flood_thread, NULL);
    for (int index = 0; index < threads; index++) {
        void *result;
        pthread_join(all[index], &result);
        sent += (uint64_t)(uintptr_t)result;
    }
    printf("{\"sent\": %lu}\n", sent);
}

static void relay(int listen, int to) {
    int in = opened(listen, 0), out = opened(0, to);
    for (;;) {
        prepare(MAX_PACKET);
        int count = recvmmsg(in, messages, BATCH, MSG_WAITFORONE, NULL);
        for (int index = 0; index < count; index++) parts[index].iov_len = messages[index].msg_len;
        if (count > 0) sendmmsg(out, messages, (unsigned)count, 0);
    }
}

int main(int count, char **words) {
    double numbers[6] = {0};
    for (int index = 2; index < count && index < 8; index++) numbers[index - 2] = atof(words[index]);
    int first = (int)numbers[0], second = (int)numbers[1];
    const char *mode = count > 3 ? words[1] : "";
    mixed = !strcmp(mode, "throughput") && numbers[5] > 0;
    if (!strcmp(mode, "throughput"))
        throughput(first, second, (uint64_t)numbers[2], (uint64_t)numbers[3], (uint64_t)numbers[4]);
    else if (!strcmp(mode, "delay")) delay(first, second, numbers[2], (uint64_t)numbers[3]);
    else if (!strcmp(mode, "flood")) flood(first, numbers[1], numbers[2], (int)numbers[3], (int)numbers[4]);
    else if (!strcmp(mode, "relay")) relay(first, second);
    else return 2;
    return 0;
}
