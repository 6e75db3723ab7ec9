//! Four DM4310 by axol-rt's socket and frames: its own calls, at 1 kHz with an absolute sleep, SCHED_FIFO 60 as rc10d.
//! Its loop is of one robot, at 240 Hz and with drives of two makers, and is left out.
//! bench/peers/run --axol-rt builds it with the user's checkout of axol.
#![allow(dead_code)]

mod can;
mod proto;

use std::time::{Duration, Instant};

const IDS: std::ops::RangeInclusive<u16> = 1..=4;
const PERIOD_NS: i64 = 1_000_000;
const SECOND_NS: i64 = 1_000_000_000;
/// Share of a period in which feedback is waited for; that of all comes some 0.5 ms after the whole millisecond.
const REPLIES: Duration = Duration::from_micros(800);
const RANGES: proto::MitRanges =
    proto::MitRanges { p_max: 12.5, v_max: 30.0, kp_max: 500.0, kd_max: 5.0, t_max: 10.0 };

fn cycle(socket: &can::CanSock, positions: &mut [f64; 4]) -> std::io::Result<()> {
    socket.drain()?;
    for id in IDS {
        socket.send(id, &proto::mit_encode(0.17, 0.0, 2.0, 1.0, 0.0, &RANGES))?;
    }
    let until = Instant::now() + REPLIES;
    let mut missing = positions.len();
    while missing > 0 {
        let Some(frame) = socket.recv_timeout(until.saturating_duration_since(Instant::now()))? else { break };
        let drive = frame.id.wrapping_sub(u32::from(proto::DM_FEEDBACK_BASE)) as u16;
        if IDS.contains(&drive) {
            let feedback = proto::dm_decode_feedback(&frame.data, RANGES.p_max, RANGES.v_max, RANGES.t_max);
            positions[usize::from(drive) - 1] = feedback.position;
            missing -= 1;
        }
    }
    Ok(())
}

fn main() -> std::io::Result<()> {
    let socket = can::CanSock::open("vcan0")?;
    for id in IDS {
        socket.send(id, &proto::DM_ENABLE)?;
    }
    let mut positions = [0.0; 4];
    // SAFETY: calls of libc with valid pointers.
    unsafe {
        let mut priority: libc::sched_param = std::mem::zeroed();
        priority.sched_priority = 60;
        if libc::sched_setscheduler(0, libc::SCHED_FIFO, &priority) != 0 {
            return Err(std::io::Error::last_os_error());
        }
        let mut next: libc::timespec = std::mem::zeroed();
        libc::clock_gettime(libc::CLOCK_MONOTONIC, &mut next);
        loop {
            cycle(&socket, &mut positions)?;
            let ns = next.tv_nsec + PERIOD_NS;
            next.tv_sec += ns / SECOND_NS;
            next.tv_nsec = ns % SECOND_NS;
            libc::clock_nanosleep(libc::CLOCK_MONOTONIC, libc::TIMER_ABSTIME, &next, std::ptr::null_mut());
        }
    }
}
