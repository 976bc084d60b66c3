//! `shapebot monitor` and `shapebot command`: an operator's side of a running robot.

use super::experiments::bar;
use crate::args::{CommandArgs, LinkArgs, MonitorArgs, OrderArgs};
use crate::drive;
use crate::failure::{Failure, Outcome};
use console::Term;
use shapebot_drive::operator::Order;
use shapebot_drive::safety::Request;
use shapebot_drive_build::DriveDescription;
use shapebot_operator::{BusLink, Client, Error, Link, line, view};
use shapebot_runtime::TUNABLE;
use std::io::Write;
use std::path::Path;
use std::time::{Duration, Instant};

/// From page to page of the monitor.
const REDRAW: Duration = Duration::from_millis(100);

/// From sign of life to sign of life on watch: a fifth of what the robot waits.
const ALIVE: Duration = Duration::from_millis(100);

/// From line to line where there is no terminal.
const LINE: Duration = Duration::from_secs(1);

/// A longer file is no plan that a robot has room for.
const LONGEST_PLAN: usize = 1 << 20;

/// Shows what a robot says.
pub(crate) fn monitor(args: &MonitorArgs) -> Outcome {
    let (mut client, drive) = connect(&args.link)?;
    let (terminal, start) = (Term::stdout(), Instant::now());
    let end = args.time.map(|seconds| start + Duration::from_secs_f64(seconds));
    let mut shown = 0;
    if args.watch {
        client.order(Order::Watch(true)).map_err(failure)?;
    }
    while end.is_none_or(|end| Instant::now() < end) {
        let time = if terminal.is_term() { REDRAW } else { LINE };
        let heard = listen(&mut client, time, args.watch)?;
        if terminal.is_term() {
            let gains = TUNABLE.map(|tunable| tunable.name);
            let page = view(client.telemetry(), &drive, &gains);
            terminal.clear_last_lines(shown)?;
            terminal.write_str(&page)?;
            shown = page.lines().count();
        } else {
            let text = if heard { line(client.telemetry()) } else { "silent".to_owned() };
            let seconds = start.elapsed().as_secs_f64();
            writeln!(anstream::stdout().lock(), "{seconds:8.1} s  {text}")?;
        }
    }
    if args.watch {
        client.order(Order::Watch(false)).map_err(failure)?;
    }
    Ok(())
}

/// Takes telemetry for a while; whether any came. On watch, the robot hears of it.
fn listen(client: &mut Client<Box<dyn Link>>, time: Duration, watch: bool) -> Outcome<bool> {
    let (end, mut heard) = (Instant::now() + time, false);
    loop {
        let rest = end.saturating_duration_since(Instant::now());
        if rest.is_zero() {
            return Ok(heard);
        }
        if watch {
            client.keep_watch().map_err(failure)?;
        }
        heard |= client.listen(rest.min(ALIVE)).map_err(failure)?;
    }
}

/// Gives an order.
pub(crate) fn command(args: &CommandArgs) -> Outcome {
    let file = match &args.order {
        OrderArgs::Upload { file } => Some(read_plan(file)?),
        _ => None,
    };
    let (mut client, _) = connect(&args.link)?;
    if let Some(file) = file {
        upload(&mut client, &file)?;
    }
    if let Some(order) = order(&args.order) {
        client.order(order).map_err(failure)?;
    }
    // Stopping is not waited for; what the robot makes of it is told.
    client.listen(Duration::from_millis(200)).map_err(failure)?;
    Ok(writeln!(anstream::stdout().lock(), "{}", line(client.telemetry()))?)
}

/// The order, unless it is an upload, which is several.
const fn order(order: &OrderArgs) -> Option<Order> {
    Some(match *order {
        OrderArgs::Upload { .. } => return None,
        OrderArgs::Start => Order::Ask(Request::Start),
        OrderArgs::Stop => Order::Ask(Request::Stop),
        OrderArgs::EStop => Order::Ask(Request::EmergencyStop),
        OrderArgs::Reset => Order::Ask(Request::Reset),
        OrderArgs::Balance => Order::Ask(Request::Balance),
        OrderArgs::KeepStation => Order::Ask(Request::KeepStation),
        OrderArgs::Track => Order::Ask(Request::Track),
        OrderArgs::Yaw => Order::Ask(Request::Yaw),
        OrderArgs::Heading { degrees } => Order::Heading(degrees.to_radians()),
        OrderArgs::Gain { name, factor } => Order::Gain(name, factor),
        OrderArgs::Watch { on } => Order::Watch(on),
    })
}

/// The bytes of a binary plan file.
pub(super) fn read_plan(path: &Path) -> Outcome<Vec<u8>> {
    let bytes = std::fs::read(path).map_err(|e| Failure::file("read", path, &e))?;
    if bytes.len() > LONGEST_PLAN || !bytes.starts_with(b"SBPL") {
        let place = path.display();
        return Err(Failure::usage(format!(
            "{place} is no binary plan file: `shapebot plan TASK -o DIR` writes one"
        )));
    }
    Ok(bytes)
}

fn upload(client: &mut Client<Box<dyn Link>>, file: &[u8]) -> Outcome {
    let progress = bar(file.len() as u64, "bytes");
    let done = client.upload(file, &mut |bytes| progress.set_position(bytes as u64));
    progress.finish_and_clear();
    done.map_err(failure)
}

fn connect(args: &LinkArgs) -> Outcome<(Client<Box<dyn Link>>, DriveDescription)> {
    let drive = drive::open(&args.drive, None)?.description;
    let link: Box<dyn Link> = match (&args.bus, &args.socket) {
        (Some(port), _) => {
            let bus = drive.buses.get(usize::from(drive.operator.bus));
            let bit_rate = bus.map_or(0, |bus| bus.bit_rate);
            Box::new(BusLink::open(port, bit_rate, drive.operator).map_err(failure)?)
        }
        (None, Some(path)) => open_socket(path)?,
        (None, None) => return Err(Failure::usage("--bus or --socket says where the robot is")),
    };
    Ok((Client::new(link, drive.fingerprint), drive))
}

#[cfg(unix)]
fn open_socket(path: &Path) -> Outcome<Box<dyn Link>> {
    match shapebot_operator::SocketLink::open(path) {
        Ok(link) => Ok(Box::new(link)),
        Err(Error::Io(error)) => Err(Failure::file("open", path, &error)),
        Err(error) => Err(failure(error)),
    }
}

#[cfg(not(unix))]
fn open_socket(_: &Path) -> Outcome<Box<dyn Link>> {
    Err(Failure::usage("local sockets are for Unix"))
}

/// The robot's refusal and silence are the robot's, the rest is the user's.
fn failure(error: Error) -> Failure {
    match error {
        Error::Refused(_) | Error::Silent(_) | Error::NotTaken(_) => Failure::refused(error),
        Error::Io(_) | Error::Bus(_) => Failure::usage(error),
    }
}
