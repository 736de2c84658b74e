import copy
import pathlib
import tempfile
import threading
import unittest
import warnings

import numpy as np

import gauntlet
from support import Test, program


class Controller(Test):
    """Of the file of `gauntlet export`, on the glove of the run that it was exported from."""

    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        out, robot = f"{folder.name}/out", f"{folder.name}/robot.yaml"
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", gauntlet.Remark)
            cls.result = gauntlet.run("random_motion", set={"glove.motion.duration_s": 1}, controllers=["tuned_kalman"],
                                      causes="none", out=out)
        program("export", out, "--controller", "tuned_kalman", "--out", robot)
        cls.robot = pathlib.Path(robot)
        cls.counts = np.array(cls.result.glove["counts"])

    def test_gives_the_commands_of_the_trial(self):
        trace = self.result.trace("tuned_kalman")["command_counts"]
        controller = gauntlet.Controller(self.robot)
        controller.reset(trace[0])  # where the trial's hand begins
        commands = controller.steps(self.counts)
        self.assertEqual(commands.shape, (len(self.counts) * controller.ticks_per_sample, len(controller.motor_names)))
        # The servos hold a frame from the delay of 25 ms on, and the trace shows that frame.
        self.assertTrue(np.array_equal(trace[25:], commands[:-25]))
        self.assertGreater(np.unique(commands, axis=0).shape[0], 10)

    def test_steps_as_in_a_loop(self):
        whole, single = gauntlet.Controller(self.robot), gauntlet.Controller(self.robot)
        commands = whole.steps(self.counts)
        looped = []
        for sample in self.counts:
            looped.append(single.step(sample))
            looped += [single.step() for _ in range(single.ticks_per_sample - 1)]
        self.assertTrue(np.array_equal(commands, looped))
        self.assertTrue(np.array_equal(whole.filtered_angle_rad, single.filtered_angle_rad))
        self.assertEqual((whole.status, whole.event), (single.status, single.event))

    def test_is_the_same_from_the_text_form(self):
        text = self.folder / "robot.txt"
        program("export", self.result.folder, "--controller", "tuned_kalman", "--text", "--out", str(text))
        self.assertTrue(np.array_equal(gauntlet.Controller(text).steps(self.counts[:50]),
                                       gauntlet.Controller(self.robot).steps(self.counts[:50])))

    def test_takes_masked_values_for_missing_ones(self):
        masked, missing = gauntlet.Controller(self.robot), gauntlet.Controller(self.robot)
        sample, mask = np.array(self.counts[0]), np.arange(len(self.counts[0])) == 3
        self.assertTrue(np.array_equal(masked.step(np.ma.masked_array(sample, mask)), missing.step(np.where(mask, np.nan, sample))))
        self.assertEqual(masked.untrusted_samples[3], 1)

    def test_takes_over_other_settings_while_it_runs(self):
        controller, expected = gauntlet.Controller(self.robot), gauntlet.Controller(self.robot)
        other = self.robot.read_text().replace("coupling_compensation: true", "coupling_compensation: false")
        prepared = controller.prepare(other)
        self.assertTrue(np.array_equal(controller.steps(self.counts[:50]), expected.steps(self.counts[:50])))
        controller.swap(prepared)
        controller.swap(prepared)  # and back
        self.assertTrue(np.array_equal(controller.steps(self.counts[50:]), expected.steps(self.counts[50:])))
        controller.swap(prepared)
        other_way = gauntlet.Controller(other).steps(self.counts)[-1]
        self.assertTrue(np.array_equal(controller.steps(self.counts)[-1], other_way), "with the settings of the other")
        self.assertIn("another glove", str(self.mistake(controller.prepare, other.replace("full_scale_counts: 1023",
                                                                                          "full_scale_counts: 2047"))))
        self.assertIn("prepare()", str(self.mistake(controller.swap, expected)))
        self.assertIn("prepare()", str(self.mistake(controller.swap, controller)))

    def test_keeps_its_last_steps(self):
        controller = gauntlet.Controller(self.robot)
        self.assertEqual(controller.recorded_steps.shape, (0, 0))
        controller.record(30)
        commands = controller.steps(self.counts[:50])
        sample = np.array(self.counts[50])
        sample[3] = np.nan
        last = controller.step(sample)
        columns, steps = controller.recorded_columns, controller.recorded_steps
        self.assertEqual(steps.shape, (30, len(columns)))
        motors = [i for i, name in enumerate(columns) if name.startswith("command_counts.")]
        self.assertTrue(np.array_equal(steps[:-1, motors], commands[-29:]))
        self.assertTrue(np.array_equal(steps[-1, motors], last))
        csv = controller.recorded_csv().splitlines()
        self.assertEqual(len(csv), 31)
        self.assertIn("missing", csv[-1])
        controller.record(0)
        self.assertEqual(controller.recorded_csv().strip(), "")

    def test_reports_late_steps_and_a_loop_of_another_rate(self):
        controller = gauntlet.Controller(self.robot)
        controller.step(elapsed_ms=1.0)
        self.assertEqual(controller.loop_status, "in_time")
        controller.step(self.counts[0], elapsed_ms=2.5)
        self.assertEqual((controller.loop_status, controller.overruns), ("overrun", 1))
        for _ in range(254):
            controller.step(elapsed_ms=2.0)
        self.assertEqual(controller.loop_status, "wrong_rate")
        self.assertAlmostEqual(controller.measured_tick_rate_hz, 500.0, delta=2.0)

    def test_lists_the_problems_of_a_robot(self):
        self.assertEqual(gauntlet.check_robot(self.robot), [])
        lines = self.robot.read_text().split("\n")
        pose = next(i for i, line in enumerate(lines) if line.startswith("    index_pip: {low_counts"))
        lines[pose] = lines[pose].split("high_angle_rad")[0] + "high_angle_rad: 6}"
        problems = gauntlet.check_robot("\n".join(lines))
        self.assertEqual(len(problems), 1)
        self.assertRegex(problems[0], f"^controller:{pose + 1}:.*warning: glove.channels.index_pip.high_angle_rad: is 6")

    def test_cannot_be_copied(self):
        controller = gauntlet.Controller(self.robot)
        for copied in (copy.copy, copy.deepcopy):
            with self.assertRaisesRegex(TypeError, "a controller cannot be copied"):
                copied(controller)

    def test_is_the_same_from_a_text_and_from_a_dict(self):
        text = self.robot.read_text()
        expected = gauntlet.Controller(self.robot).steps(self.counts)
        self.assertTrue(np.array_equal(expected, gauntlet.Controller(text).steps(self.counts)))
        try:
            import yaml
        except ImportError:
            return  # the dict has no other source
        self.assertTrue(np.array_equal(expected, gauntlet.Controller(yaml.safe_load(text)).steps(self.counts)))

    def test_counts_what_it_does_not_trust(self):
        controller = gauntlet.Controller(self.robot)
        sample = np.full(len(controller.channel_names), 500.0)
        controller.step(sample)
        self.assertEqual(controller.status, "good")
        sample[2] = np.nan
        controller.step(sample)
        self.assertEqual(controller.untrusted_samples[2], 1)
        self.assertEqual(controller.untrusted_samples.sum(), 1)
        self.assertEqual(controller.status, "held")
        ages = [controller.sample_age_ms(name) for name in controller.channel_names]
        self.assertEqual(ages, [1.0 if i == 2 else 0.0 for i in range(len(ages))])
        controller.reset()
        self.assertEqual(controller.untrusted_samples.sum(), 0)

    def test_refuses_wrong_shapes(self):
        controller = gauntlet.Controller(self.robot)
        channels = len(controller.channel_names)
        for call, argument in [(controller.step, np.zeros(channels + 1)), (controller.step, np.zeros((1, channels))),
                               (controller.steps, np.zeros(channels)), (controller.steps, np.zeros((5, channels - 1))),
                               (controller.take_joint_angles, [0.0]), (controller.reset, [0.5])]:
            with self.subTest(call=call.__name__):
                self.assertEqual(self.mistake(call, argument).place, "controller")
        self.assertIn("whole number", str(self.mistake(controller.reset, np.full(len(controller.motor_names), 0.5))))
        self.assertIn("not a channel", str(self.mistake(controller.sample_age_ms, "no_finger")))

    def test_names_the_place_in_the_file(self):
        lines = self.robot.read_text().replace("event_period_ms", "event_periode_ms")
        error = self.mistake(gauntlet.Controller, lines)
        self.assertRegex(error.place, r"^controller:\d+:\d+$")
        self.assertEqual(error.key, "timing.event_periode_ms")

    def test_belongs_to_one_thread_at_a_time(self):
        controllers = [gauntlet.Controller(self.robot) for _ in range(2)]
        samples = np.tile(self.counts, (30, 1))
        expected = gauntlet.Controller(self.robot).steps(samples)
        results, refusals = [None, None], []

        def work(i):
            results[i] = controllers[i].steps(samples)

        threads = [threading.Thread(target=work, args=(i,)) for i in range(2)]
        for thread in threads:
            thread.start()
        while threads[0].is_alive():  # the same controller is in use
            try:
                controllers[0].step()
                break
            except gauntlet.RunError as error:
                refusals.append(str(error))
        for thread in threads:
            thread.join()
        self.assertTrue(np.array_equal(results[1], expected))
        for refusal in refusals:
            self.assertIn("another thread is using it", refusal)


if __name__ == "__main__":
    unittest.main()
