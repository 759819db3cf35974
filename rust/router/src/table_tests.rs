use super::*;

const A: PortId = 0;
const B: PortId = 1;
const C: PortId = 2;

fn ports(table: &Table, system: u8, component: u8) -> Option<Vec<PortId>> {
    table.ports_to(system, component).map(|ports| ports.iter().collect())
}

fn learn(table: &mut Table, heard: &[(u8, u8, PortId)]) {
    for &(system, component, port) in heard {
        table.learn(system, component, port, false, 0);
    }
}

#[test]
fn an_address_is_reached_over_the_ports_that_heard_it() {
    let mut table = Table::default();
    learn(&mut table, &[(1, 1, A), (1, 100, B), (2, 1, C)]);
    assert_eq!(ports(&table, 1, 1), Some(vec![A]));
    assert_eq!(ports(&table, 1, 100), Some(vec![B]));
    assert_eq!(ports(&table, 1, 55), Some(vec![A, B]), "an unknown component: all ports of its system");
    assert_eq!(ports(&table, 1, 0), Some(vec![A, B]), "all components");
    assert_eq!(ports(&table, 3, 1), None);
}

#[test]
fn system_0_is_never_learned_and_component_0_is_no_address() {
    let mut table = Table::default();
    learn(&mut table, &[(0, 1, A), (250, 0, B)]);
    assert_eq!(ports(&table, 0, 1), None);
    assert_eq!(ports(&table, 250, 0), Some(vec![B]));
    assert_eq!(ports(&table, 250, 190), Some(vec![B]));
    learn(&mut table, &[(250, 190, C)]);
    assert_eq!(ports(&table, 250, 190), Some(vec![C]));
    assert_eq!(ports(&table, 250, 0), Some(vec![B, C]));
}

#[test]
fn a_verified_address_has_no_other_ports() {
    let mut table = Table::default();
    learn(&mut table, &[(1, 1, A)]);
    assert_eq!(table.learn(1, 1, B, true, 0), Learned::New);
    assert_eq!(ports(&table, 1, 1), Some(vec![B]));
    assert_eq!(table.learn(1, 1, A, false, 0), Learned::Spoofed);
    assert_eq!(table.learn(1, 1, B, false, 0), Learned::Known, "an unsigned one that the link allows");
    learn(&mut table, &[(1, 99, C)]);
    assert_eq!(ports(&table, 1, 0), Some(vec![B]), "a forged component does not lead packets of its system away");
    table.unverify(B);
    assert_eq!(table.learn(1, 1, A, false, 0), Learned::New);
    assert_eq!(ports(&table, 1, 1), Some(vec![A, B]));
}

#[test]
fn a_removed_port_is_forgotten() {
    let mut table = Table::default();
    learn(&mut table, &[(1, 1, A), (1, 1, B), (2, 1, A)]);
    table.remove_port(A);
    assert_eq!(ports(&table, 1, 1), Some(vec![B]));
    assert_eq!(ports(&table, 2, 1), None);
    assert_eq!(table.addresses().len(), 1);
}

#[test]
fn a_falling_boot_time_clears_the_routes_of_its_sender() {
    let mut table = Table::default();
    learn(&mut table, &[(1, 1, A), (1, 1, B), (1, 100, C)]);
    assert!(!table.note_boot_time(1, 1, A, 90_000));
    assert!(!table.note_boot_time(1, 1, B, 89_000), "overtaken on a redundant link");
    assert_eq!(ports(&table, 1, 1), Some(vec![A, B]));
    assert!(table.note_boot_time(1, 1, B, 3_000));
    assert_eq!(ports(&table, 1, 1), Some(vec![B]));
    assert_eq!(ports(&table, 1, 0), Some(vec![B, C]));
    assert!(!table.note_boot_time(1, 1, A, 4_000));
    assert!(!table.note_boot_time(9, 9, A, 4_000));
}

#[test]
fn the_table_is_bounded_and_keeps_what_was_heard_for_long_or_verified() {
    let mut table = Table::default();
    table.learn(1, 1, A, true, 0);
    table.learn(2, 1, B, false, 0);
    table.learn(2, 1, B, false, 2 * MIN_HEARD);
    for forged in 0..=u16::MAX {
        let [system, component] = forged.to_be_bytes();
        table.learn(system, component, C, false, 2 * MIN_HEARD + u64::from(forged));
        assert!(table.routes.len() <= MAX_ADDRESSES);
    }
    assert_eq!(ports(&table, 1, 1), Some(vec![A]));
    assert!(ports(&table, 2, 1).is_some_and(|ports| ports.contains(&B)));
}
