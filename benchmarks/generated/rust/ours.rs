// Parses a flight and encodes attitudes with the crate of `mav gen rust`; prints seconds per message.
use mavlink_ardupilotmega::messages::Attitude;
use mavlink_ardupilotmega::{Encoder, Message, Parser};
use std::hint::black_box;
use std::time::Instant;

fn parse(data: &[u8]) -> usize {
    let (mut parser, mut count, mut sum) = (Parser::new(), 0, 0.0f32);
    for chunk in data.chunks(16384) {
        for packet in parser.push(chunk) {
            if let Some(message) = packet.message() {
                count += 1;
                if let Message::Attitude(attitude) = black_box(&message) {
                    sum += attitude.roll;
                }
            }
        }
    }
    black_box(sum);
    count
}

fn encode(count: usize) -> usize {
    let mut encoder = Encoder::new(1, 1);
    let mut attitude = Attitude { yawspeed: 1.5, ..Default::default() };
    for index in 0..count {
        attitude.time_boot_ms = index as u32;
        attitude.roll = 0.5 + index as f32;
        black_box(encoder.encode(&attitude).expect("version 2 carries every message").as_bytes());
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
