//! The bundled drives: our master against the simulated nodes of its description, over frames.

mod descriptions;

use descriptions::description;
use shapebot_bus::{Frame, VirtualBus};
use shapebot_drive::safety::{Request, State};
use shapebot_drive::{Command, DriveTable, Fault, Master, Measurement};
use shapebot_drive_build::DriveDescription;
use shapebot_nodes::{DriveUnit, Mechanism, Network, Node, NodeFault, YawAxis, described};

/// Coordinates that do not feel each other, each with inertia 1.
#[derive(Debug)]
struct Free {
    position: Vec<f64>,
    rate: Vec<f64>,
    force: Vec<f64>,
    legs: f64,
}

impl Free {
    fn new(count: usize) -> Self {
        let zero = vec![0.0; count];
        Self { position: zero.clone(), rate: zero.clone(), force: zero, legs: 1.0 }
    }
}

impl Mechanism for Free {
    fn coordinate(&self, index: usize) -> f64 {
        self.position[index]
    }

    fn rate(&self, index: usize) -> f64 {
        self.rate[index]
    }

    fn set_force(&mut self, index: usize, force: f64) {
        self.force[index] = force;
    }

    fn set_legs(&mut self, extension: f64) {
        self.legs = extension;
    }

    fn advance(&mut self, seconds: f64) {
        for k in 0..self.position.len() {
            self.position[k] += (self.rate[k] + 0.5 * self.force[k] * seconds) * seconds;
            self.rate[k] += self.force[k] * seconds;
        }
    }
}

type World = Network<DriveUnit<Free>>;

fn world(description: &DriveDescription) -> World {
    let buses = description.buses.iter().map(|bus| VirtualBus::new(bus.bit_rate, 0)).collect();
    let nodes = described(&description.simulated);
    let nodes = nodes.iter().map(|(bus, settings)| (*bus, Node::new(settings))).collect();
    let free = Free::new(description.coordinates.len());
    Network::new(buses, nodes, DriveUnit::new(description, free, YawAxis::default()))
}

/// Runs master and network up to a time; `forces` is asked once a cycle.
fn run(
    master: &mut Master<'_>,
    world: &mut World,
    until: u64,
    mut forces: impl FnMut(&Measurement) -> Vec<f32>,
) {
    loop {
        let now = shapebot_bus::Bus::now(world);
        let mut frames: Vec<(usize, Frame)> = Vec::new();
        master.poll(now, &mut |bus, frame| frames.push((bus, frame)));
        if master.inputs_due(now) {
            let measurement = master.measure(now);
            let command = Command::new(&forces(measurement));
            master.command(&command, now, &mut |bus, frame| frames.push((bus, frame)));
        }
        for (bus, frame) in frames {
            world.send(bus, &frame).unwrap();
        }
        if now >= until {
            return;
        }
        let wake = master.next_wake().clamp(now + 1, until);
        if let Some((bus, received)) = world.receive(wake) {
            master.receive(bus, &received.frame, received.time);
        }
    }
}

fn ready<'a>(table: &'a DriveTable<'a>, world: &mut World) -> Master<'a> {
    let mut master = Master::new(table);
    let time = shapebot_bus::Bus::now(world) + 3_000_000;
    run(&mut master, world, time, |_| Vec::new());
    let faults = master.faults().first();
    let failed = master.failed_step();
    assert_eq!(master.state(), State::LegsDown, "{} {faults:?} {failed:?}", table.name);
    master
}

fn started<'a>(table: &'a DriveTable<'a>, world: &mut World) -> Master<'a> {
    let mut master = ready(table, world);
    let now = shapebot_bus::Bus::now(world);
    assert!(master.request(Request::Start, now));
    run(&mut master, world, now + 1_500_000, |_| vec![0.0; 8]);
    let faults = master.faults().first();
    assert_eq!(master.state(), State::Balancing, "{}: {faults:?}", table.name);
    master
}

#[test]
fn every_bundled_drive_is_set_up_started_and_stopped() {
    for (name, _) in shapebot_drives::DRIVES {
        let description = description(name);
        let tables = description.tables();
        let table = tables.table();
        let mut world = world(&description);
        let mut master = started(&table, &mut world);
        let now = shapebot_bus::Bus::now(&world);
        master.request(Request::Stop, now);
        run(&mut master, &mut world, now + 1_500_000, |_| vec![0.0; 8]);
        assert_eq!(master.state(), State::LegsDown, "{name}");
        assert_eq!(master.counters().malformed, 0, "{name}");
    }
}

#[test]
fn forces_reach_the_coordinates_and_positions_come_back() {
    for (name, _) in shapebot_drives::DRIVES {
        let description = description(name);
        let tables = description.tables();
        let table = tables.table();
        let mut world = world(&description);
        let mut master = started(&table, &mut world);
        let mut last = None;
        let now = shapebot_bus::Bus::now(&world);
        // A force of its own for each actuator.
        run(&mut master, &mut world, now + 40_000, |measurement| {
            last = Some(*measurement);
            (1..=8).map(|k| 0.3 * k as f32).collect()
        });
        let measurement = last.unwrap();
        let free = world.plant_now().mechanism();
        for axis in description.axes.iter() {
            let (Some(coordinate), Some(force)) = (axis.coordinate, axis.force) else { continue };
            let (coordinate, wanted) = (usize::from(coordinate), 0.3 * f64::from(force + 1));
            let step = 1.0 / axis.counts_per_force;
            let found = free.force[coordinate];
            let error = (found - wanted).abs();
            assert!(error <= 0.51 * step + 1e-3, "{name}: {}: {found} for {wanted}", axis.name);
            // The coordinate moved by some hundredths; what the master says is one cycle old.
            let moved = free.position[coordinate];
            let said = measurement.position(coordinate);
            assert!(moved != 0.0, "{name}: {}", axis.name);
            assert!((said - moved).abs() < 0.1 * moved.abs() + 1e-3, "{name}: {said} for {moved}");
        }
    }
}

#[test]
fn a_turned_drive_unit_changes_nothing_for_the_controller() {
    for (name, _) in shapebot_drives::DRIVES {
        let description = description(name);
        let Some(yaw) = description.yaw else { continue };
        let tables = description.tables();
        let table = tables.table();
        let mut world = world(&description);
        // The drive unit is 70° behind the body.
        world.plant_now().set_heading(1.2);
        let mut master = started(&table, &mut world);
        let now = shapebot_bus::Bus::now(&world);
        run(&mut master, &mut world, now + 20_000, |_| vec![2.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        let [x, y] = yaw
            .plane
            .map(|axis| usize::from(description.axes[usize::from(axis)].coordinate.unwrap()));
        let free = world.plant_now().mechanism();
        let (along, across) = (free.force[x], free.force[y]);
        assert!((along - 2.0).abs() < 0.05 && across.abs() < 0.05, "{name}: {along}, {across}");
        assert!(free.rate[x] > 10.0 * free.rate[y].abs(), "{name}");
    }
}

/// Faults of nodes, and the faults of the master that may follow.
#[test]
fn injected_faults_are_detected_and_end_torque_and_legs_up() {
    let cases: [(&str, NodeFault, &[Fault]); 8] = [
        ("front", NodeFault::Dead, &[Fault::MissedInputs]),
        ("front", NodeFault::Reset, &[Fault::MissedInputs, Fault::Reboot]),
        ("front", NodeFault::HeartbeatLoss, &[Fault::Heartbeat]),
        ("front", NodeFault::NoInputs, &[Fault::MissedInputs]),
        ("front", NodeFault::Emergency(0x2310), &[Fault::Emergency, Fault::DriveFault]),
        ("imu", NodeFault::StaleSensor, &[Fault::SensorStale]),
        ("imu", NodeFault::Unhealthy(1), &[Fault::SensorUnhealthy]),
        ("imu", NodeFault::Dead, &[Fault::MissedInputs, Fault::SensorStale]),
    ];
    let description = description("ballbot3d");
    let tables = description.tables();
    let table = tables.table();
    for (node, fault, expected) in cases {
        let mut world = world(&description);
        let mut master = started(&table, &mut world);
        let index = description.node(node).unwrap();
        world.inject(index, fault);
        let now = shapebot_bus::Bus::now(&world);
        run(&mut master, &mut world, now + 2_500_000, |_| vec![1.0, 0.0]);
        let found = master.faults().first();
        assert!(
            found.is_some_and(|record| expected.contains(&record.fault)),
            "{node} {fault:?}: {found:?}"
        );
        assert_eq!(master.state(), State::FaultDown, "{node} {fault:?}");
        let plant = world.plant_now();
        let forces: Vec<f64> = plant.mechanism().force.clone();
        assert!(forces.iter().all(|force| *force == 0.0), "{node} {fault:?}: {forces:?}");
        assert_eq!(plant.mechanism().legs, 1.0, "{node} {fault:?}: legs are down");
    }
}
