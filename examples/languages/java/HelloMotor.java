import java.io.IOException;
import java.util.Locale;
import java.util.Random;
import java.util.concurrent.LinkedBlockingQueue;
import java.util.concurrent.TimeUnit;
import lcm.lcm.LCM;
import lcm.lcm.LCMDataInputStream;
import lcm.lcm.LCMSubscriber;
import rc10.command_t;
import rc10.event_t;
import rc10.motor_state_t;
import rc10.named_value_t;
import rc10.request_t;
import rc10.response_t;
import rc10.robot_state_t;
import rc10.setpoint_t;

/**
 * Enables one motor, turns it for a second and prints its state; Ctrl-C lets go of it. Java 11, with nothing but LCM.
 *
 * <p>HelloMotor ROBOT MOTOR RPM
 */
public class HelloMotor implements LCMSubscriber {
  private static final String CLIENT = "hello-java";
  private static final int MOTOR_STATUS = 100; // code of the events "ACTIVE -> READY (…)"
  private static final long PAUSE_US = 100_000; // between two commands: Ctrl-Z, a busy computer
  private static final long PATIENCE_US = 1_000_000; // for a state of after it
  private static final long LET_GO_MS = 10_000; // longer than a request waits for its answer

  private final LCM lcm = new LCM();
  private final String robot;
  private final String motor;
  private final long session = new Random().nextLong(); // of this run; a later run has another
  private long seq = 0; // grows with every message of ours
  private long printedUs = 0;
  private long commandedUs = 0;
  private volatile boolean interrupted = false;
  // LCM calls messageReceived() from a thread of its own.
  private volatile boolean enabled = false; // by us
  private volatile motor_state_t newest = null;
  private volatile long stateUs = 0; // after newest, of which it is the time
  private volatile String stopped = null; // by whom or by what
  private final LinkedBlockingQueue<response_t> answers = new LinkedBlockingQueue<>();

  HelloMotor(String robot, String motor) throws IOException {
    this.robot = robot;
    this.motor = motor;
    // LCM takes regular expressions.
    lcm.subscribe(robot + "\\.v1\\.state", this);
    lcm.subscribe(robot + "\\.v1\\.event", this);
    lcm.subscribe(robot + "\\.v1\\.response", this);
  }

  @Override
  public void messageReceived(LCM from, String channel, LCMDataInputStream data) {
    try {
      if (channel.endsWith(".response")) {
        response_t response = new response_t(data);
        // All clients hear all answers.
        if (response.session != session) return;
        if (response.status == response_t.STATUS_OK) enabled = true; // the first one does that
        answers.add(response);
      } else if (channel.endsWith(".event")) {
        judge(new event_t(data));
      } else {
        take(new robot_state_t(data));
      }
    } catch (IOException error) {
      System.err.println("HelloMotor: " + channel + ": other definitions: " + error.getMessage());
    }
  }

  private void take(robot_state_t state) {
    for (motor_state_t one : state.motors) {
      if (!one.name.equals(motor)) continue;
      newest = one;
      if (state.mono_us < printedUs + 100_000) continue;
      printedUs = state.mono_us;
      System.out.printf(
          Locale.ROOT,
          "%s status %d owner '%s' target %.1f measured %.1f rpm %.2f A%n",
          one.name, one.status, one.owner, one.target, one.velocity_rpm, one.current_a);
    }
    stateUs = state.mono_us;
  }

  /** A motor that was stopped, and that somebody enables anew, is not driven on. */
  private void judge(event_t event) {
    boolean ofMotor = event.code == MOTOR_STATUS && event.source.equals(motor);
    if (enabled && ofMotor && event.text.startsWith("ACTIVE -> ")) stop(event.text);
  }

  private synchronized void stop(String why) {
    if (stopped == null) stopped = why;
  }

  /** Sends a request under one number until it is answered: rc10d carries it out once. */
  private boolean request(String operation, named_value_t... values) throws InterruptedException {
    request_t message = new request_t();
    message.client = CLIENT;
    message.session = session;
    message.seq = ++seq;
    message.operation = operation;
    message.target = motor;
    message.value_count = values.length;
    message.values = values;
    for (int i = 0; i < 50; ++i) {
      lcm.publish(robot + ".v1.request", message);
      response_t answer = answers.poll(100, TimeUnit.MILLISECONDS);
      while (answer != null && answer.seq != message.seq) answer = answers.poll();
      if (answer == null) continue;
      if (answer.status != response_t.STATUS_OK) System.err.println("HelloMotor: " + answer.message);
      return answer.status == response_t.STATUS_OK;
    }
    System.err.println("HelloMotor: no answer to '" + operation + "': is rc10d running?");
    return false;
  }

  /** CLOCK_MONOTONIC, as in the states: that is what nanoTime() is on Linux. */
  private static long nowUs() {
    return System.nanoTime() / 1000;
  }

  /**
   * False once the motor was stopped. Events of a pause of ours may be lost: a state of after it shows what has
   * become of the target.
   */
  private boolean mayGoOn() throws InterruptedException {
    long resumedUs = nowUs();
    if (commandedUs > 0 && resumedUs > commandedUs + PAUSE_US) {
      while (stateUs < resumedUs && nowUs() < resumedUs + PATIENCE_US) Thread.sleep(5);
      motor_state_t now = newest;
      boolean ours = now != null && now.owner.equals(CLIENT);
      boolean lapsed =
          now != null && now.owner.isEmpty() && now.stop_cause == motor_state_t.STOP_TIMEOUT;
      if (stateUs < resumedUs || !(ours || lapsed)) stop("in a pause of this program");
    }
    return stopped == null;
  }

  private void command(byte mode, double value) {
    setpoint_t setpoint = new setpoint_t();
    setpoint.motor = motor;
    setpoint.mode = mode;
    setpoint.value = value;
    setpoint.stiffness_nm_per_rad = Float.NaN;
    setpoint.damping_nms_per_rad = Float.NaN;
    command_t message = new command_t();
    message.client = CLIENT;
    message.session = session;
    message.seq = ++seq;
    message.validity_ms = 100;
    message.setpoint_count = 1;
    message.setpoints = new setpoint_t[] {setpoint};
    lcm.publish(robot + ".v1.command", message);
    commandedUs = nowUs();
  }

  public static void main(String[] words) throws Exception {
    if (words.length != 3) {
      System.err.println("usage: HelloMotor ROBOT MOTOR RPM");
      System.exit(2);
    }
    double rpm = Double.parseDouble(words[2]); // before anything is enabled
    HelloMotor program = new HelloMotor(words[0], words[1]);
    // Ctrl-C and SIGTERM start the hooks, while main() goes on. This one has main() end its loop and disable the
    // motor as ever, and waits for it: when the hooks are done the process is gone.
    Thread main = Thread.currentThread();
    Thread hook =
        new Thread(
            () -> {
              program.interrupted = true;
              try {
                main.join(LET_GO_MS);
              } catch (InterruptedException error) {
                Thread.currentThread().interrupt();
              }
            });
    Runtime.getRuntime().addShutdownHook(hook);
    boolean enabled = program.request("enable");
    // The loop is what keeps the motor going: a command acts for 100 ms.
    for (int i = 0; enabled && !program.interrupted && program.mayGoOn() && i < 50; ++i) {
      program.command(setpoint_t.MODE_VELOCITY, rpm);
      Thread.sleep(20);
    }
    boolean disabled = false;
    if (program.mayGoOn()) {
      program.command(setpoint_t.MODE_COAST, 0.0);
      // With our end: what an e-stop holds meanwhile stays held.
      named_value_t atEnd = new named_value_t();
      atEnd.name = "at_end";
      atEnd.value = 1;
      disabled = program.request("disable", atEnd);
    } else { // and, if it is enabled again, in the hands of another
      System.err.println("HelloMotor: " + words[1] + " was stopped: " + program.stopped);
    }
    if (program.interrupted) return; // the hook waits for that; the exit status is 130
    Runtime.getRuntime().removeShutdownHook(hook);
    System.exit(enabled && disabled ? 0 : 1);
  }
}
