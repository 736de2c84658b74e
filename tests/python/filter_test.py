import copy
import sys
import threading
import unittest
import warnings

import numpy as np

import gauntlet
from support import Test


KALMAN = {"kind": "kalman", "r": 20}


def noisy(rows=400, columns=3, seed=1):
    generator = np.random.default_rng(seed)
    return np.round(500 + 100 * np.sin(np.arange(rows)[:, None] / 40 + np.arange(columns)) +
                    generator.normal(0, 5, (rows, columns)))


class Filter(Test):
    def of_program(self, values, kind, *settings):
        """The same filter as a stream of CSV."""
        with open("in.csv", "w") as file:
            print(*(f"c{i}" for i in range(values.shape[1])), sep=",", file=file)
            for row in values:
                print(*(repr(float(value)) for value in row), sep=",", file=file)
        command = f'"$GAUNTLET_PROGRAM" filter {kind} {" ".join(f"--set {text}" for text in settings)} < in.csv'
        import subprocess
        text = subprocess.run(["bash", "-c", command], text=True, capture_output=True, check=True).stdout
        return [[float(field or "nan") for field in line.split(",")] for line in text.splitlines()[1:]]

    def test_holds_the_last_good_value_where_one_is_masked(self):
        with self.assertWarns(gauntlet.Remark):
            held = gauntlet.filter(np.ma.masked_array([1, 2, 3], [0, 1, 0]), "none", rate_hz=100)
        self.assertEqual(held.tolist(), [1, 1, 3])
        stepped = gauntlet.Filter("none", rate_hz=100)
        rows = np.ma.masked_array([[1.0, 5.0], [2.0, 6.0]], [[0, 0], [1, 0]])
        self.assertEqual([stepped.step(row).tolist() for row in rows], [[1, 5], [1, 6]])

    def test_every_kind_gives_the_numbers_of_the_program(self):
        values = noisy(columns=18)
        kinds = gauntlet.filter_kinds()
        self.assertIn("one_euro", kinds)
        for kind in kinds:
            with self.subTest(kind):
                ours = gauntlet.filter(values, kind, rate_hz=1000)
                theirs = np.array(self.of_program(values, kind, "rate_hz=1000"))
                # The stream has the shortest text of each number up to its digits.
                np.testing.assert_allclose(ours, theirs, rtol=1e-5)

    def test_settings_reach_the_filter(self):
        values = noisy()
        mean = gauntlet.filter(values, "moving_average", window=4)
        expected = np.stack([values[max(0, k - 3):k + 1].mean(axis=0) for k in range(len(values))])
        np.testing.assert_allclose(mean[3:], expected[3:], rtol=1e-12)
        self.assertTrue(np.array_equal(mean, gauntlet.filter(values, {"kind": "moving_average", "window": 4})))

    def test_settings_of_another_library_are_read_as_it_means_them(self):
        step = np.array([0.0, 100.0])
        theirs = {"kind": "exponential", "like": "dex-retargeting", "low_pass_alpha": 0.36}
        self.assertAlmostEqual(gauntlet.filter(step, theirs)[1], 36.0)
        # 40 Hz there are 20 Hz here: 1 - 0.64^2.
        self.assertAlmostEqual(gauntlet.filter(step, theirs, loop_hz=40, rate_hz=20)[1], 59.04)
        with self.assertRaisesRegex(ValueError, "rate_hz: is needed"):
            gauntlet.filter(step, theirs, loop_hz=40)

    def test_takes_every_layout_and_type_of_real_numbers(self):
        values = noisy()
        whole = gauntlet.filter(values, KALMAN)
        views = {"fortran": np.asfortranarray(values), "every second column": np.repeat(values, 2, axis=1)[:, ::2],
                 "reversed twice": values[::-1].copy()[::-1], "float32": values.astype(np.float32),
                 "int16": values.astype(np.int16), "big endian": values.astype(">f8"), "list": values.tolist()}
        for name, view in views.items():
            with self.subTest(name):
                self.assertTrue(np.array_equal(whole, gauntlet.filter(view, KALMAN)))
        one = gauntlet.filter(values[:, 0], KALMAN)
        self.assertEqual(one.shape, (len(values),))
        self.assertTrue(np.array_equal(one, whole[:, 0]))

    def test_writes_into_out_also_where_it_is_the_input(self):
        values = noisy()
        before = values.copy()
        expected = gauntlet.filter(values, KALMAN)
        self.assertTrue(np.array_equal(before, values))
        out = np.zeros_like(values)
        self.assertIs(gauntlet.filter(values, KALMAN, out=out), out)
        self.assertTrue(np.array_equal(out, expected))
        shared = np.zeros((len(values) + 1, values.shape[1]))
        shared[1:] = values  # the output overlaps the input, one row before it
        self.assertTrue(np.array_equal(gauntlet.filter(shared[1:], KALMAN, out=shared[:-1]), expected))
        gauntlet.filter(values, KALMAN, out=values)
        self.assertTrue(np.array_equal(values, expected))

    def test_holds_missing_values_and_says_so(self):
        values = noisy(columns=2)
        values[:7, 0] = np.nan
        values[50:60, 1] = [np.nan, np.inf, -np.inf, 1e200, -1e200] * 2
        with self.assertWarnsRegex(gauntlet.Remark, "17 missing values held"):
            result = gauntlet.filter(values, KALMAN)
        self.assertTrue(np.isnan(result[:7, 0]).all())
        self.assertTrue(np.isfinite(result[7:, 0]).all() and np.isfinite(result[:, 1]).all())
        held = values.copy()
        held[50:60, 1] = held[49, 1]
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            self.assertTrue(np.array_equal(result[:, 1], gauntlet.filter(held[:, 1], KALMAN)))
            self.assertTrue(np.array_equal(result[7:, 0], gauntlet.filter(values[7:, 0], KALMAN)))

    def test_refuses_what_is_no_signal(self):
        values = noisy()
        wrong = [("dimensions", np.zeros((2, 2, 2)), {}), ("dimensions", 3.0, {}), ("real numbers", [1j, 2j], {}),
                 ("real numbers", ["a", "b"], {}), ("real numbers", [True, False], {}), ("no channels", np.zeros((4, 0)), {}),
                 ("float64", values, {"out": values.astype(np.float32)}), ("shape", values, {"out": np.zeros((3, 3))}),
                 ("shape", values[:, 0], {"out": np.zeros_like(values)}), ("contiguous", values, {"out": np.asfortranarray(values)}),
                 ("is no array", values, {"out": [1.0]})]
        for expected, array, named in wrong:
            with self.subTest(expected=expected, named=list(named)):
                self.assertIn(expected, str(self.mistake(gauntlet.filter, array, KALMAN, **named)))
        fixed = np.zeros_like(values)
        fixed.flags.writeable = False
        error = self.mistake(gauntlet.filter, values, KALMAN, out=fixed)
        self.assertEqual((error.place, error.key), ("filter", "out"))

    def test_asks_for_the_rate_only_where_it_counts(self):
        values = noisy()
        error = self.mistake(gauntlet.filter, values, "one_euro")
        self.assertEqual((error.place, error.key), ("filter", "rate_hz"))
        for wrong in (0, -5, float("nan"), float("inf")):
            error = self.mistake(gauntlet.filter, values, "one_euro", rate_hz=wrong)
            self.assertEqual((error.place, error.key), ("filter", "rate_hz"))
        gauntlet.filter(values, "median")
        slow = gauntlet.filter(values, "one_euro", rate_hz=100)
        self.assertFalse(np.array_equal(slow, gauntlet.filter(values, "one_euro", rate_hz=1000)))

    def test_of_nothing_is_nothing(self):
        self.assertEqual(gauntlet.filter(np.zeros((0, 4)), KALMAN).shape, (0, 4))

    def test_steps_give_the_numbers_of_arrays_bit_for_bit(self):
        values = noisy(columns=18)
        values[:3, 4] = values[20:22, 5] = np.nan
        for kind in gauntlet.filter_kinds():
            with self.subTest(kind):
                with warnings.catch_warnings():
                    warnings.simplefilter("ignore")
                    expected = gauntlet.filter(values, kind, rate_hz=100)
                one = gauntlet.Filter(kind, rate_hz=100)
                for again in range(2):
                    steps = np.array([one.step(row, t=5 + k / 100) for k, row in enumerate(values)])
                    np.testing.assert_array_equal(steps, expected)
                    self.assertEqual(one.held, 5)
                    one.reset()
        for kind in ("one_euro", "butterworth", "median", KALMAN):
            one = gauntlet.Filter(kind, rate_hz=100)
            numbers = [one.step(float(value)) for value in values[:, 0]]
            self.assertIs(type(numbers[0]), float)
            self.assertEqual(numbers, gauntlet.filter(values[:, 0], kind, rate_hz=100).tolist())

    def test_a_step_takes_every_kind_of_sample(self):
        row = np.array([3.0, 1.0, 2.0])
        expected = gauntlet.Filter("none").step(row)
        self.assertIsNot(expected, row)
        for sample in (row.tolist(), row.astype(np.float32), np.repeat(row, 2)[::2], row.astype(">f8"), row.astype(int)):
            np.testing.assert_array_equal(gauntlet.Filter("none").step(sample), expected)
        for sample in (3, 3.0, np.float32(3)):
            self.assertEqual(gauntlet.Filter("none").step(sample), 3.0)
        one = gauntlet.Filter(KALMAN)
        out = np.empty(3)
        self.assertIs(one.step(row, out=out), out)
        self.assertIs(one.step(x=row, t=None, out=row), row)
        before = sys.getrefcount(out)
        for _ in range(100):
            one.step(row, None, out)
        self.assertEqual(sys.getrefcount(out), before)

    def test_a_step_refuses_what_is_no_sample(self):
        one = gauntlet.Filter(KALMAN)
        for wrong in (np.zeros((2, 3)), np.zeros(0), ["a"], [1j], np.array(1.0)):
            self.assertEqual(self.mistake(one.step, wrong).place, "filter")
        one.step(np.zeros(3))
        self.assertIn("the sample is an array of 2, must be an array of 3", str(self.mistake(one.step, np.zeros(2))))
        self.assertIn("the sample is a number, must be an array of 3", str(self.mistake(one.step, 1.0)))
        fixed = np.zeros(3)
        fixed.flags.writeable = False
        for out in (np.zeros(2), np.zeros(3, np.float32), fixed, [0, 0, 0]):
            self.assertEqual(self.mistake(one.step, np.zeros(3), out=out).key, "out")
        shared = np.zeros(4)
        self.assertIn("overlaps", str(self.mistake(one.step, shared[1:], out=shared[:3])))
        for arguments, named in (((), {}), ((1, 2, 3, 4), {}), ((1,), {"x": 1}), ((1,), {"z": 1}), ((None,), {}), ((1, "now"), {})):
            with self.assertRaises(TypeError):
                gauntlet.Filter("none", rate_hz=1).step(*arguments, **named)
        for call in (lambda: gauntlet.Filter("one_euro"), lambda: gauntlet.Filter("one_euro", rate_hz=0),
                     lambda: gauntlet.Filter("none").step(1, t=0)):
            self.assertEqual(self.mistake(call).key, "rate_hz")
        self.assertEqual(self.mistake(gauntlet.Filter, "kalman", qq=1).key, "qq")
        with self.assertRaisesRegex(TypeError, "make a new one"):
            copy.copy(one)

    def test_a_step_says_where_the_times_are_not_those_of_the_rate(self):
        one = gauntlet.Filter("one_euro", rate_hz=100)
        times = np.arange(300) / 100
        for t in times + np.random.default_rng(1).uniform(-0.002, 0.002, len(times)):
            one.step(1.0, t=t)
        for gap in (0.03, 0.016, 0.004, 0, -0.01, float("nan")):
            one = gauntlet.Filter("one_euro", rate_hz=100)
            one.step(1.0, t=7)
            error = self.mistake(one.step, 2.0, t=7 + gap)
            self.assertEqual((error.place, error.key), ("filter", "t"))
            one.step(2.0, t=7.01)  # as if the wrong one had not been
            one.reset()
            one.step(2.0, t=0)
        one.reset()
        with self.assertRaisesRegex(gauntlet.SettingError, "comes at 80 Hz in the mean, rate_hz is 100"):
            for k in range(100):
                one.step(1.0, t=k / 80)

    def test_runs_in_threads_at_once(self):
        values = [noisy(20000, 8, seed) for seed in range(4)]
        expected = [gauntlet.filter(array, KALMAN) for array in values]
        results = [None] * 4
        threads = [threading.Thread(target=lambda i=i: results.__setitem__(i, gauntlet.filter(values[i], KALMAN)))
                   for i in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        for result, array in zip(results, expected):
            self.assertTrue(np.array_equal(result, array))


if __name__ == "__main__":
    unittest.main()
