//! The same input gives the same bits.

use crate::scenes::drum;
use dem_core::snapshot::Snapshot;

#[test]
fn one_two_and_four_threads_give_the_same_bits() {
    let hash = |threads| {
        let mut world = drum(600, 1.5, threads).build().unwrap();
        world.run(6000).unwrap();
        assert!(world.contact_count() > 100 && world.list_builds() > 10);
        world.state_hash()
    };
    let one = hash(1);
    assert_eq!(one, hash(2));
    assert_eq!(one, hash(4));
}

#[test]
fn steps_in_one_call_or_many_give_the_same_bits() {
    let mut once = drum(200, 1.0, 1).build().unwrap();
    let mut often = drum(200, 1.0, 1).build().unwrap();
    once.run(700).unwrap();
    for _ in 0..70 {
        often.run(10).unwrap();
    }
    assert_eq!(once.state_hash(), often.state_hash());
}

#[test]
fn a_restart_goes_on_bit_by_bit_at_every_later_step() {
    let build = |threads| drum(300, 2.0, threads).build().unwrap();
    let mut straight = build(1);
    straight.open_ledger().unwrap();
    straight.run(1500).unwrap();
    let bytes = straight.snapshot().to_bytes();
    let snapshot = Snapshot::from_bytes(&bytes).unwrap();
    assert_eq!(snapshot, straight.snapshot());
    let mut resumed = build(2);
    resumed.restore(&snapshot).unwrap();
    assert_eq!(resumed.wall_load(0).unwrap(), straight.wall_load(0).unwrap());
    for _ in 0..300 {
        straight.run(1).unwrap();
        resumed.run(1).unwrap();
        assert_eq!(straight.state_hash(), resumed.state_hash());
        assert_eq!(straight.energy(), resumed.energy());
        assert_eq!(straight.wall_load(0).unwrap(), resumed.wall_load(0).unwrap());
    }
    assert_eq!(straight.snapshot(), resumed.snapshot());
}

#[test]
fn a_damaged_or_foreign_snapshot_is_refused() {
    let world = drum(50, 1.0, 1).build().unwrap();
    let mut bytes = world.snapshot().to_bytes();
    assert!(Snapshot::from_bytes(&bytes[..bytes.len() - 9]).is_err());
    assert!(Snapshot::from_bytes(&[]).is_err());
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    let error = Snapshot::from_bytes(&bytes).unwrap_err().to_string();
    assert!(error.contains("checksum"), "{error}");
    let mut other = drum(51, 1.0, 1).build().unwrap();
    let error = other.restore(&world.snapshot()).unwrap_err().to_string();
    assert!(error.contains("number of particles is 50, expected 51"), "{error}");
}

#[test]
fn the_open_ledger_changes_no_bit() {
    let mut plain = drum(300, 1.0, 1).build().unwrap();
    let mut booked = drum(300, 1.0, 1).build().unwrap();
    booked.open_ledger().unwrap();
    for _ in 0..20 {
        plain.run(50).unwrap();
        booked.run(50).unwrap();
        assert_eq!(plain.state_hash(), booked.state_hash());
    }
}
