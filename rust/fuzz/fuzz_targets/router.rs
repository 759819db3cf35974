//! The router never panics, sends no packet back, changes no byte, and keeps keys and the state of radios on their link.
#![no_main]

use fuzz_dialect::{dialect, stream};
use libfuzzer_sys::fuzz_target;
use mavstack_core::parser::Parser;
use mavstack_router::ports::PortId;
use mavstack_router::router::{Origin, Router, Sink, Time, Unsent};
use std::sync::Arc;

const PORTS: usize = 5;
const SETUP_SIGNING: u32 = 256;
const RADIO_STATUS: u32 = 109;

/// The packets that one packet caused.
#[derive(Default)]
struct Sent(Vec<(PortId, Vec<u8>)>);

impl Sink for Sent {
    fn send(&mut self, port: PortId, packet: &[u8], _: Origin) -> Result<(), Unsent> {
        self.0.push((port, packet.to_vec()));
        Ok(())
    }
}

fuzz_target!(|data: &[u8]| {
    let [choice, plan @ ..] = data else { return };
    let dialect = Arc::new(dialect());
    let mut router = Router::new(Arc::clone(&dialect), u64::from(choice & 1) * 1000);
    let ports: Vec<PortId> = (0..PORTS as u32)
        .map(|number| {
            let endpoint = router.add_endpoint(number);
            if let Some(endpoint) = router.endpoint_mut(endpoint) {
                endpoint.group = (number < u32::from(choice >> 5)).then(|| "group".to_owned());
            }
            router.add_port(endpoint).expect("room")
        })
        .collect();
    let bytes = if choice & 2 == 2 { stream(plan, &dialect) } else { plan.to_vec() };
    let mut now = 1;
    for (number, part) in bytes.chunks(64).enumerate() {
        let from = ports[number % PORTS];
        Parser::new(false).feed(&dialect, part, |packet| {
            now += 10;
            let mut sent = Sent::default();
            router.route(from, &packet, Time { now, signing: now }, &mut sent);
            let stays = matches!(packet.header.message_id, SETUP_SIGNING | RADIO_STATUS);
            assert!(sent.0.is_empty() || !stays);
            assert!(sent.0.iter().all(|(port, bytes)| *port != from && bytes == packet.raw));
        });
        if part.first() == Some(&0) {
            router.remove_port(from);
            assert_eq!(router.add_port(number % PORTS), Some(from));
        }
    }
});
