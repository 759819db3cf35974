// A program in the style of those for the official C++ library, and what is new: visit, variants, fields by name.
#include <cassert>
#include <cstdlib>
#include <iostream>

#include "common/parser.hpp"

#define CHECK(condition) ((condition) ? (void)0 : (std::cout << __LINE__ << ": " #condition "\n", std::exit(1)))

using namespace mavlink;

// As in MAVROS: a message through the base class, its payload through MsgMap.
static void test_base_class()
{
    common::msg::HEARTBEAT heartbeat{};
    heartbeat.type = static_cast<uint8_t>(common::MAV_TYPE::QUADROTOR);
    heartbeat.custom_mode = 4;
    const Message &message = heartbeat;
    mavlink_status_t status{};
    mavlink_message_t packet;
    MsgMap map(packet);
    message.serialize(map);
    const auto info = message.get_message_info();
    CHECK(mavlink_finalize_message_buffer(&packet, 1, 2, &status, static_cast<uint8_t>(info.min_length),
                                          static_cast<uint8_t>(info.length), info.crc_extra) == 21);
    minimal::msg::HEARTBEAT decoded;
    MsgMap reader(&packet);
    decoded.deserialize(reader);
    CHECK(decoded.custom_mode == 4 && decoded.type == 2 && decoded.mavlink_version == 3);
    CHECK(message.get_name() == "HEARTBEAT");
    CHECK(decoded.to_yaml() == "HEARTBEAT:\n  type: 2\n  autopilot: 0\n  base_mode: 0\n  custom_mode: 4\n"
                               "  system_status: 0\n  mavlink_version: 3\n");
}

static void test_texts()
{
    common::msg::STATUSTEXT text{};
    set_string_z(text.text, "hello");
    CHECK(to_string(text.text) == "hello");
    CHECK(text.to_yaml().find("  text: \"hello\"\n") != std::string::npos);
    set_string(text.text, std::string(60, 'x'));
    CHECK(to_string(text.text).size() == 50);
    common::msg::GPS_STATUS satellites{};
    satellites.satellite_prn[1] = 7;
    CHECK(satellites.to_yaml().find("satellite_prn: [0, 7, 0") != std::string::npos);
}

struct Attitudes {
    float roll;
    int others;
    void operator()(const common::msg::ATTITUDE &attitude) { roll = attitude.roll; }
    void operator()(const common::msg::VFR_HUD &) { others++; }
};

static void test_parser()
{
    common::msg::ATTITUDE attitude{};
    attitude.roll = 0.5f;
    mavlink_status_t link{};
    mavlink_message_t packet;
    uint8_t bytes[2 * MAVLINK_MAX_PACKET_LEN];
    size_t length = 0;
    CHECK(encode(attitude, 1, 1, link, packet) > 0);
    length += mavlink_msg_to_send_buffer(bytes, &packet);
    CHECK(encode(common::msg::VFR_HUD(), 1, 1, link, packet) > 0);
    length += mavlink_msg_to_send_buffer(bytes + length, &packet);
    CHECK(encode(common::msg::SYSTEM_TIME(), 1, 1, link, packet) > 0);
    length += mavlink_msg_to_send_buffer(bytes + length, &packet);
    common::Parser parser;
    Attitudes seen{0.0f, 0};
    int calls = 0;
    parser.parse(bytes, length, [&](const mavlink_message_t &received) { calls += common::visit(received, seen); });
    CHECK(seen.roll > 0.4f && seen.others == 1 && calls == 2 && parser.counters().good == 3);
#if __cplusplus >= 201703L
    using Alternatives = std::variant<common::msg::HEARTBEAT, common::msg::SYSTEM_TIME>;
    const auto variant = common::to_variant<Alternatives>(packet);
    CHECK(variant && std::holds_alternative<common::msg::SYSTEM_TIME>(*variant));
    CHECK(common::visit(*variant, [](const auto &message) { return message.MSG_ID; }) == 2);
#endif
}

int main()
{
    test_base_class();
    test_texts();
    test_parser();
    std::cout << "done\n";
    return 0;
}
