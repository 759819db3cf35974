use super::*;
use crate::tests::dialect;
use proptest::prelude::*;

fn decide(rules: &mut Rules, packet: &Summary, now: u64) -> Verdict {
    rules.decide(packet, now, |_| {})
}

fn summary(message_id: u32, system: u8) -> Summary {
    let slot = dialect().entry(message_id).map(|entry| entry.slot);
    Summary { message_id, slot, system, component: 1, ..Summary::default() }
}

#[test]
fn the_first_rule_that_matches_decides() {
    let rules = vec![
        Rule { messages: vec![0], systems: vec![255], ..Rule::default() },
        Rule { action: Action::Inspect, messages: vec![77_777], ..Rule::default() },
        Rule { action: Action::Drop, messages: vec![0], ..Rule::default() },
    ];
    let mut rules = Rules::new(rules, Action::Pass, &dialect());
    assert_eq!(decide(&mut rules, &summary(0, 255), 0), Verdict::Pass);
    assert_eq!(decide(&mut rules, &summary(0, 1), 0), Verdict::Drop(Some(2)));
    assert_eq!(decide(&mut rules, &summary(77_777, 1), 0), Verdict::Inspect);
    assert_eq!(decide(&mut rules, &summary(2, 1), 0), Verdict::Pass);
    let counted: Vec<_> = rules.counters().map(|(_, counters)| (counters.matched, counters.dropped)).collect();
    assert_eq!(counted, [(1, 0), (1, 0), (1, 1)]);
}

#[test]
fn commands_are_a_condition_of_command_messages_alone() {
    let rules = vec![Rule { action: Action::Drop, commands: vec![400, 22], ..Rule::default() }];
    let mut rules = Rules::new(rules, Action::Pass, &dialect());
    let command = |command| Summary { command: Some(command), ..summary(76, 255) };
    assert_eq!(decide(&mut rules, &command(400), 0), Verdict::Drop(Some(0)));
    assert_eq!(decide(&mut rules, &command(401), 0), Verdict::Pass);
    assert_eq!(decide(&mut rules, &summary(0, 255), 0), Verdict::Pass);
}

#[test]
fn a_rate_limits_what_a_rule_lets_pass() {
    let rules = vec![Rule { messages: vec![0], rate: Some(2.0), ..Rule::default() }];
    let mut rules = Rules::new(rules, Action::Drop, &dialect());
    let verdicts: Vec<_> =
        (0..4).map(|step| decide(&mut rules, &summary(0, 1), step * 250_000) == Verdict::Pass).collect();
    assert_eq!(verdicts, [true, true, true, false]);
    assert_eq!(decide(&mut rules, &summary(2, 1), 0), Verdict::Drop(None));
}

#[test]
fn a_dry_run_only_counts() {
    let rules = vec![
        Rule { action: Action::Drop, dry_run: true, ..Rule::default() },
        Rule { action: Action::Inspect, target_systems: vec![7], ..Rule::default() },
    ];
    let mut rules = Rules::new(rules, Action::Pass, &dialect());
    let mut reported = Vec::new();
    assert_eq!(rules.decide(&summary(0, 1), 0, |index| reported.push(index)), Verdict::Pass);
    let addressed = Summary { target_system: 7, ..summary(0, 1) };
    assert_eq!(rules.decide(&addressed, 0, |index| reported.push(index)), Verdict::Inspect);
    assert_eq!(reported, [0, 0]);
}

/// A rule of random conditions, small numbers so that they often hold.
fn rule() -> impl Strategy<Value = Rule> {
    let few = |max: u8| prop::collection::vec(0..max, 0..3);
    let action = prop_oneof![Just(Action::Pass), Just(Action::Drop), Just(Action::Inspect)];
    let messages = prop::collection::vec(prop_oneof![Just(0), Just(76), Just(77_777), Just(2)], 0..3);
    (action, messages, few(3), few(3), few(3), prop::collection::vec(0u16..3, 0..2)).prop_map(
        |(action, messages, systems, components, target_systems, commands)| Rule {
            action,
            messages,
            systems,
            components,
            target_systems,
            commands,
            ..Rule::default()
        },
    )
}

/// The meaning of a rule, written without bits and lists.
fn plainly_matches(rule: &Rule, packet: &Summary) -> bool {
    let holds = |ids: &[u8], id: u8| ids.is_empty() || ids.contains(&id);
    (rule.messages.is_empty() || rule.messages.contains(&packet.message_id))
        && holds(&rule.systems, packet.system)
        && holds(&rule.components, packet.component)
        && holds(&rule.target_systems, packet.target_system)
        && (rule.commands.is_empty() || packet.command.is_some_and(|command| rule.commands.contains(&command)))
}

proptest! {
    #[test]
    fn compiled_rules_decide_as_written(
        rules in prop::collection::vec(rule(), 0..8),
        id in prop_oneof![Just(0u32), Just(76), Just(77_777), Just(2), Just(30)],
        (system, component, target_system, command) in (0u8..3, 0u8..3, 0u8..3, 0u16..3),
    ) {
        let command = (id == 76).then_some(command);
        let packet = Summary { component, target_system, command, ..summary(id, system) };
        let plain = match rules.iter().position(|rule| plainly_matches(rule, &packet)) {
            None => Verdict::Drop(None),
            Some(index) => match rules[index].action {
                Action::Pass => Verdict::Pass,
                Action::Drop => Verdict::Drop(Some(index)),
                Action::Inspect => Verdict::Inspect,
            },
        };
        prop_assert_eq!(decide(&mut Rules::new(rules, Action::Drop, &dialect()), &packet, 0), plain);
    }
}
