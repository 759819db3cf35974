// The conformance runner of the C++ library (see conformance/README.md).
#include <cstdlib>
#include <iostream>
#include <sstream>
#include <string>
#include <vector>

#include DIALECT_HEADER

using namespace mavlink;

static const char *const DIGITS = "0123456789abcdef";

static std::vector<uint8_t> read_hex(const std::string &text)
{
    std::vector<uint8_t> bytes;
    for (size_t i = 0; i + 1 < text.size(); i += 2) {
        bytes.push_back(static_cast<uint8_t>(std::stoi(text.substr(i, 2), nullptr, 16)));
    }
    return bytes;
}

struct FieldPrinter {
    template <typename T>
    static void print_value(const T &value)
    {
        uint8_t bytes[sizeof(T)];
        _mavlink_copy(bytes, &value, sizeof(T));
        for (uint8_t byte : bytes) {
            std::cout << DIGITS[byte >> 4] << DIGITS[byte & 15];
        }
    }

    template <typename T>
    void operator()(const FieldInfo &field, const T &value) const
    {
        std::cout << ' ' << field.name << '=';
        print_value(value);
    }

    template <typename T, size_t N>
    void operator()(const FieldInfo &field, const std::array<T, N> &values) const
    {
        std::cout << ' ' << field.name << '=';
        for (const T &value : values) {
            print_value(value);
        }
    }
};

struct PacketPrinter {
    const mavlink_message_t &packet;
    mavlink_status_t &link;

    template <typename M>
    void operator()(const M &message) const
    {
        uint8_t bytes[MAVLINK_MAX_PACKET_LEN];
        mavlink_message_t packed;
        const bool version_1 = packet.magic == MAVLINK_STX_MAVLINK1;
        std::cout << "packet " << M::NAME << ' ' << packet.msgid << ' ' << (version_1 ? 1 : 2) << ' ' << +packet.seq << ' '
                  << +packet.sysid << ' ' << +packet.compid << ' ' << (packet.incompat_flags & MAVLINK_IFLAG_SIGNED);
        message.for_each_field(FieldPrinter());
        std::cout << "\npacked " << M::NAME << ' ';
        encode(message, packet.sysid, packet.compid, link, packed);
        const uint16_t length = mavlink_msg_to_send_buffer(bytes, &packed);
        for (uint16_t i = 0; i < length; i++) {
            FieldPrinter::print_value(bytes[i]);
        }
        std::cout << '\n';
    }
};

// Prints a packet, and packs its message as its sender did.
static void print_packet(const mavlink_message_t &packet, const mavlink_signing_t &signing)
{
    mavlink_status_t link{};
    mavlink_signing_t key = signing;
    link.current_tx_seq = packet.seq;
    link.flags = packet.magic == MAVLINK_STX_MAVLINK1 ? MAVLINK_STATUS_FLAG_OUT_MAVLINK1 : 0;
    if (signing.flags != 0 && (packet.incompat_flags & MAVLINK_IFLAG_SIGNED) != 0) {
        key.link_id = packet.signature[0];
        key.timestamp = 0;
        for (int i = 6; i > 0; i--) {
            key.timestamp = key.timestamp << 8 | packet.signature[i];
        }
        link.signing = &key;
    }
    if (!DIALECT::visit(packet, PacketPrinter{packet, link})) {
        std::exit(1);
    }
}

int main(int argc, char **argv)
{
    const size_t chunk = argc > 1 ? static_cast<size_t>(std::atoi(argv[1])) : 64;
    std::string line;
    while (std::getline(std::cin, line)) {
        std::istringstream words(line);
        std::string name, key, now, text;
        words >> name >> key >> now >> text;
        const std::vector<uint8_t> input = read_hex(text);
        mavlink_signing_t signing{};
        mavlink_signing_streams_t streams{};
        DIALECT::Parser parser;
        if (key != "-") {
            const std::vector<uint8_t> bytes = read_hex(key);
            std::memcpy(signing.secret_key, bytes.data(), bytes.size());
            signing.flags = MAVLINK_SIGNING_FLAG_SIGN_OUTGOING;
            signing.timestamp = now == "-" ? 0 : std::stoull(now);
            parser.set_signing(&signing, &streams);
        }
        for (size_t start = 0; start < input.size(); start += chunk) {
            const size_t length = chunk < input.size() - start ? chunk : input.size() - start;
            parser.parse(input.data() + start, length,
                         [&signing](const mavlink_message_t &packet) { print_packet(packet, signing); });
        }
        std::cout << "end " << name << " good=" << parser.counters().good << " bad_crc=" << parser.counters().bad_crc
                  << " bad_signature=" << parser.counters().bad_signature << " unknown=" << parser.counters().unknown
                  << '\n';
    }
    return 0;
}
