// Parses a flight and encodes attitudes with the crate `mavlink`; prints seconds per message.
use mavlink::dialects::ardupilotmega::{MavMessage, ATTITUDE_DATA};
use mavlink::error::MessageReadError;
use mavlink::{write_v2_msg, MavHeader, MavlinkReader};
use std::hint::black_box;
use std::time::Instant;

fn parse(data: &[u8]) -> usize {
    let (mut reader, mut count, mut sum) = (MavlinkReader::new(data), 0, 0.0f32);
    loop {
        match reader.read_any_message::<MavMessage>() {
            Ok((_, message)) => {
                if let MavMessage::ATTITUDE(attitude) = black_box(&message) {
                    sum += attitude.roll;
                }
            }
            Err(MessageReadError::Io(_)) => break,
            // A message with a value that its enum lacks: the crate refuses it.
            Err(MessageReadError::Parse(_)) => {}
        }
        count += 1;
    }
    black_box(sum);
    count
}

fn encode(count: usize) -> usize {
    let mut packet = Vec::with_capacity(300);
    let mut header = MavHeader { system_id: 1, component_id: 1, sequence: 0 };
    let mut attitude = ATTITUDE_DATA { yawspeed: 1.5, ..Default::default() };
    for index in 0..count {
        attitude.time_boot_ms = index as u32;
        attitude.roll = 0.5 + index as f32;
        packet.clear();
        write_v2_msg(&mut packet, header, &MavMessage::ATTITUDE(attitude.clone())).expect("memory");
        header.sequence = header.sequence.wrapping_add(1);
        black_box(&packet);
    }
    count
}

fn main() {
    let words: Vec<String> = std::env::args().collect();
    let data = std::fs::read(&words[2]).expect("the file of packets");
    let count: usize = words[3].parse().expect("the number of messages");
    let start = Instant::now();
    let done = if words[1] == "parse" { parse(&data) } else { encode(count) };
    assert_eq!(done, count);
    println!("{:e}", start.elapsed().as_secs_f64() / count as f64);
}
