//! What runs on a robot, called with inputs that the optimiser cannot know. If a panic were reachable
//! from it, the program would need a function that does not exist, and would not link.
//!
//! To check another function, add a call of it to [`everything`].
#![no_std]

mod drive;
mod plan;
mod runtime;

use core::hint::black_box;
use core::panic::PanicInfo;

unsafe extern "C" {
    /// Defined nowhere: the linker's complaint is the message.
    safe fn a_panic_is_reachable() -> !;
}

#[panic_handler]
fn panic(_: &PanicInfo<'_>) -> ! {
    a_panic_is_reachable()
}

/// Where the program begins.
// SAFETY: no other symbol of that name, since nothing but this is linked.
#[unsafe(no_mangle)]
pub extern "C" fn _start() -> ! {
    everything();
    loop {}
}

/// All that is checked.
fn everything() {
    plan::of_any_bytes::<f32, 1, 1, 1>();
    plan::of_any_bytes::<f32, 2, 2, 2>();
    plan::of_any_bytes::<f32, 2, 6, 6>();
    plan::of_any_bytes::<f64, 2, 6, 6>();
    runtime::controller_of_any_numbers();
    runtime::runtime_of_any_tables();
    runtime::operator_of_any_bytes();
    drive::master_of_any_tables();
    drive::slcan_of_any_bytes();
    #[cfg(feature = "planted")]
    planted(unknown([1, 2, 3]), unknown(0));
}

/// A value of which nothing is known, with `value` as an example.
fn unknown<T>(value: T) -> T {
    black_box(value)
}

/// Calls `use_bytes` with any number of bytes.
fn with_bytes(use_bytes: impl FnOnce(&[u8])) {
    let buffer = unknown([0; 4096]);
    use_bytes(buffer.get(..unknown(100)).unwrap_or(&buffer));
}

/// An index that nothing bounds.
#[cfg(feature = "planted")]
fn planted(numbers: [u32; 3], index: usize) {
    black_box(numbers[index]);
}
